#include "report/report.h"

#include <array>
#include <nlohmann/json.hpp>

namespace insitu {

std::string_view report_status_name(insitu_status status) {
  constexpr std::array<std::string_view, 11> names{"ok",
                                                   "invalid_argument",
                                                   "invalid_handle",
                                                   "wrong_state",
                                                   "unsupported",
                                                   "out_of_memory",
                                                   "over_budget",
                                                   "io",
                                                   "comm",
                                                   "abi",
                                                   "internal"};
  return status >= 0 && static_cast<size_t>(status) < names.size() ? names[static_cast<size_t>(status)] : "unknown";
}

std::string to_json_line(const StepReport& report) {
  using nlohmann::ordered_json;
  ordered_json effects = ordered_json::array();
  for (const EffectCost& effect : report.effects) {
    effects.push_back({{"name", effect.name}, {"rays", effect.rays}, {"seconds", effect.seconds}});
  }
  ordered_json line;
  line["step"] = report.step;
  line["time"] = report.time;
  line["images"] = report.images;
  line["seconds"] = {
      {"build", report.build_s}, {"render", report.render_s}, {"write", report.write_s}, {"total", report.total_s}};
  line["bytes"] = {{"borrowed", report.bytes_borrowed},
                   {"copied", report.bytes_copied},
                   {"owned", report.bytes_owned},
                   {"peak", report.bytes_peak}};
  line["items"] = {{"total", report.items_total}, {"skipped", report.items_skipped}};
  line["effects"] = std::move(effects);
  line["warnings"] = report.warnings;
  line["status"] = report_status_name(report.status);
  if (report.status != INSITU_OK) line["error"] = report.error;
  // The writer itself turns numbers that are not finite into null.
  return line.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace insitu
