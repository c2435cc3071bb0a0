#include "report/report.h"

#include <array>
#include <nlohmann/json.hpp>
#include <vector>

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

namespace {

// Scalars are the library's to write: escapes, UTF-8, the shortest numbers, null for those that are not finite. Objects
// and arrays are put together here: nlohmann's destructors of these allocate, and end the process when memory is short.
std::string scalar(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string member(std::string_view name, const std::string& value) { return scalar(name) + ":" + value; }

std::string joined(char open, const std::vector<std::string>& parts, char close) {
  std::string text(1, open);
  for (const std::string& part : parts) text.append(text.size() == 1 ? "" : ",").append(part);
  return text + close;
}

std::string object(const std::vector<std::string>& members) { return joined('{', members, '}'); }

std::string strings(const std::vector<std::string>& values) {
  std::vector<std::string> parts;
  for (const std::string& value : values) parts.push_back(scalar(value));
  return joined('[', parts, ']');
}

std::string list_of(const std::vector<EffectCost>& effects) {
  std::vector<std::string> parts;
  for (const EffectCost& effect : effects)
    parts.push_back(object({member("name", scalar(effect.name)), member("rays", scalar(effect.rays)),
                            member("seconds", scalar(effect.seconds))}));
  return joined('[', parts, ']');
}

}  // namespace

std::string to_json_line(const StepReport& report) {
  std::vector<std::string> members = {
      member("step", scalar(report.step)),
      member("time", scalar(report.time)),
      member("images", strings(report.images)),
      member("seconds", object({member("build", scalar(report.build_s)), member("render", scalar(report.render_s)),
                                member("write", scalar(report.write_s)), member("total", scalar(report.total_s))})),
      member("bytes",
             object({member("borrowed", scalar(report.bytes_borrowed)), member("copied", scalar(report.bytes_copied)),
                     member("owned", scalar(report.bytes_owned)), member("peak", scalar(report.bytes_peak))})),
      member("items",
             object({member("total", scalar(report.items_total)), member("skipped", scalar(report.items_skipped)),
                     member("filtered", scalar(report.items_filtered))})),
      member("pixels", object({member("total", scalar(report.pixels)), member("samples", scalar(report.samples)),
                               member("over_error", scalar(report.pixels_over_error))})),
      member(
          "trees",
          object({member("built", scalar(report.trees_built)), member("repaired", scalar(report.trees_repaired)),
                  member("reused", scalar(report.trees_reused)), member("moved", scalar(report.items_moved)),
                  member("treelets", scalar(report.treelets)), member("treelet_bytes", scalar(report.treelet_bytes))})),
      member("effects", list_of(report.effects)),
      member("warnings", strings(report.warnings)),
      member("status", scalar(report_status_name(report.status)))};
  if (report.status != INSITU_OK) members.push_back(member("error", scalar(report.error)));
  return object(members);
}

}  // namespace insitu
