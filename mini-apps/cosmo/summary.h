// The files that tell of a run as a whole.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "options.h"
#include "picture.h"

namespace cosmo {

// A file that is opened before the run, so that a bad name is no disappointment at its end.
class OutputFile {
 public:
  // Opens nothing for an empty path. Throws std::invalid_argument when the file cannot be written.
  explicit OutputFile(const std::string& path);
  std::FILE* file() const { return file_.get(); }
  explicit operator bool() const { return file_ != nullptr; }
  const std::string& path() const { return path_; }
  // Whether all that was written is on its way to the disk.
  bool complete() { return !file_ || (std::fflush(file_.get()) == 0 && std::ferror(file_.get()) == 0); }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
};

struct RunCost {
  double total_s = 0.0;  // wall time from the first thing done for the start to the last picture
  double setup_s = 0.0;  // of it the start: random field, tables
  double color_s = 0.0;  // of it finding the colours, by the simulation, for the pictures
  std::uint64_t steps = 0;
  std::uint64_t pictures = 0;
  std::uint64_t particle_bytes = 0;
  std::uint64_t mesh_bytes = 0;
  Picture::Cost library;

  double share() const { return library.calls_s / total_s; }
  double step_s() const { return (total_s - library.calls_s - setup_s - color_s) / static_cast<double>(steps); }
  std::uint64_t host_bytes() const { return particle_bytes + mesh_bytes; }
  std::uint64_t extra_bytes() const { return library.peak_bytes - library.frame_buffer_bytes; }
  double extra_share() const { return static_cast<double>(extra_bytes()) / static_cast<double>(host_bytes()); }
  double particle_extra_share() const {
    return static_cast<double>(extra_bytes()) / static_cast<double>(particle_bytes);
  }
};

void write_summary(const Options& options, const RunCost& cost, OutputFile& out);

}  // namespace cosmo
