// What a step cost and made, as one line of JSON. docs/report.md lists the members with their units.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "insitu/insitu.h"

namespace insitu {

struct EffectCost {
  std::string name;  // "camera", "shadows", "ambient_occlusion", ...
  uint64_t rays = 0;
  double seconds = 0;
};

struct StepReport {
  uint64_t step = 0;
  double time = 0;                  // simulation's time unit
  std::vector<std::string> images;  // files written in this step, as named to the library, patterns filled in

  double build_s = 0;  // wall time in seconds, as are the next three
  double render_s = 0;
  double write_s = 0;
  double total_s = 0;

  uint64_t bytes_borrowed = 0;
  uint64_t bytes_copied = 0;
  uint64_t bytes_owned = 0;
  uint64_t bytes_peak = 0;

  uint64_t items_total = 0;
  uint64_t items_skipped = 0;
  uint64_t items_filtered = 0;

  uint64_t pixels = 0;             // rendered
  uint64_t samples = 0;            // camera rays through them
  uint64_t pixels_over_error = 0;  // of adaptive images: at their most samples, and still above the tolerated error
  uint64_t trees_built = 0;
  uint64_t trees_repaired = 0;
  uint64_t trees_reused = 0;
  uint64_t items_moved = 0;
  uint64_t treelets = 0;
  uint64_t treelet_bytes = 0;

  std::vector<EffectCost> effects;
  std::vector<std::string> warnings;

  insitu_status status = INSITU_OK;
  std::string error;  // text of the step's first error; written only when status is not ok
};

// The word for a status that the report uses: "ok", "invalid_argument", ..., "unknown".
std::string_view report_status_name(insitu_status status);

// One line without its end. Members stand in a fixed order; numbers that are not finite become null; bytes that are not
// UTF-8 become U+FFFD. Throws nothing but std::bad_alloc.
std::string to_json_line(const StepReport& report);

struct AppendResult {
  insitu_status status = INSITU_OK;
  std::string message;  // empty when ok; otherwise one sentence that names the file and the reason
};

// Adds `line` and a line end to the file `path`, created with mode 0666 less the umask when it is missing. The file is
// open only during the call. When the line does not fit (disk full), what was written of it is cut off again if no one
// else appended meanwhile. Status: ok, io.
AppendResult append_line(const std::string& path, std::string_view line);

}  // namespace insitu
