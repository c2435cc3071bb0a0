#include "report/report.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace insitu {
namespace {

using nlohmann::ordered_json;

StepReport full_report() {
  StepReport report;
  report.step = 18446744073709551615u;
  report.time = 0.1;
  report.images = {"frame_000042.png", "frame \"42\".exr"};
  report.build_s = 0.5;
  report.render_s = 1.25;
  report.write_s = 0.0625;
  report.total_s = 2.0;
  report.bytes_borrowed = 240;
  report.bytes_copied = 16;
  report.bytes_owned = 4096;
  report.bytes_peak = 8192;
  report.items_total = 10;
  report.items_skipped = 3;
  report.items_filtered = 4;
  report.pixels = 250000;
  report.samples = 1000000;
  report.pixels_over_error = 12;
  report.trees_built = 1;
  report.trees_repaired = 2;
  report.trees_reused = 4;
  report.items_moved = 7;
  report.treelets = 65536;
  report.treelet_bytes = 599232;
  report.effects = {{"camera", 1000000, 0.75}, {"ambient_occlusion", 8000000, 0.5}};
  report.warnings = {"3 particles were skipped: position is not finite"};
  report.status = INSITU_ERROR_IO;
  report.error = "disk full";
  return report;
}

TEST(Report, WholeLine) {
  EXPECT_EQ(to_json_line(full_report()),
            R"({"step":18446744073709551615,"time":0.1,"images":["frame_000042.png","frame \"42\".exr"],)"
            R"("seconds":{"build":0.5,"render":1.25,"write":0.0625,"total":2.0},)"
            R"("bytes":{"borrowed":240,"copied":16,"owned":4096,"peak":8192},)"
            R"("items":{"total":10,"skipped":3,"filtered":4},)"
            R"("pixels":{"total":250000,"samples":1000000,"over_error":12},)"
            R"("trees":{"built":1,"repaired":2,"reused":4,"moved":7,"treelets":65536,"treelet_bytes":599232},)"
            R"("effects":[{"name":"camera","rays":1000000,"seconds":0.75},)"
            R"({"name":"ambient_occlusion","rays":8000000,"seconds":0.5}],)"
            R"("warnings":["3 particles were skipped: position is not finite"],"status":"io","error":"disk full"})");
}

TEST(Report, EmptyStep) {
  EXPECT_EQ(to_json_line(StepReport()),
            R"({"step":0,"time":0.0,"images":[],"seconds":{"build":0.0,"render":0.0,"write":0.0,"total":0.0},)"
            R"("bytes":{"borrowed":0,"copied":0,"owned":0,"peak":0},"items":{"total":0,"skipped":0,"filtered":0},)"
            R"("pixels":{"total":0,"samples":0,"over_error":0},)"
            R"("trees":{"built":0,"repaired":0,"reused":0,"moved":0,"treelets":0,"treelet_bytes":0},)"
            R"("effects":[],"warnings":[],"status":"ok"})");
}

TEST(Report, ErrorOnlyWhenThereIsOne) {
  StepReport report = full_report();
  report.status = INSITU_OK;
  EXPECT_FALSE(ordered_json::parse(to_json_line(report)).contains("error"));
  report.status = INSITU_ERROR_INTERNAL;
  report.error.clear();
  EXPECT_EQ(ordered_json::parse(to_json_line(report)).at("error"), "");
}

TEST(Report, NumbersComeBackBitForBit) {
  StepReport report;
  for (const double value : {0.1, 1.0 / 3.0, 1e300, -5e-324, 123456789.125}) {
    report.time = value;
    report.effects = {{"camera", std::numeric_limits<uint64_t>::max(), value}};
    const ordered_json json = ordered_json::parse(to_json_line(report));
    EXPECT_EQ(json.at("time").get<double>(), value);
    EXPECT_EQ(json.at("effects").at(0).at("seconds").get<double>(), value);
    EXPECT_EQ(json.at("effects").at(0).at("rays").get<uint64_t>(), std::numeric_limits<uint64_t>::max());
  }
}

TEST(Report, NumbersThatAreNotFiniteBecomeNull) {
  StepReport report = full_report();
  report.time = std::numeric_limits<double>::quiet_NaN();
  report.total_s = std::numeric_limits<double>::infinity();
  report.effects[1].seconds = -std::numeric_limits<double>::infinity();
  const ordered_json json = ordered_json::parse(to_json_line(report));
  EXPECT_TRUE(json.at("time").is_null());
  EXPECT_TRUE(json.at("seconds").at("total").is_null());
  EXPECT_TRUE(json.at("effects").at(1).at("seconds").is_null());
}

TEST(Report, AnyBytesInNamesGiveOneValidLine) {
  StepReport report = full_report();
  std::string all_bytes;
  for (int byte = 0; byte < 256; ++byte) all_bytes += static_cast<char>(byte);
  report.images = {all_bytes, "\xc3\xa9t\xc3\xa9.png", "\xff.png", "cut \xe2\x82"};
  report.effects[0].name = "\x80";
  report.warnings = {"two\nlines\r"};
  report.error = all_bytes;
  const std::string line = to_json_line(report);
  EXPECT_EQ(line.find_first_of("\n\r"), std::string::npos);
  const ordered_json json = ordered_json::parse(line);
  EXPECT_EQ(json.at("images").at(1), "\xc3\xa9t\xc3\xa9.png");
  EXPECT_EQ(json.at("images").at(2), "\xef\xbf\xbd.png");
  EXPECT_EQ(json.at("warnings").at(0), "two\nlines\r");
}

TEST(Report, EveryStatusHasItsWord) {
  std::set<std::string_view> words;
  for (insitu_status status = INSITU_OK; status <= INSITU_ERROR_INTERNAL; ++status) {
    EXPECT_NE(report_status_name(status), "unknown") << status;
    words.insert(report_status_name(status));
  }
  EXPECT_EQ(words.size(), 11u);
  EXPECT_EQ(report_status_name(INSITU_ERROR_OVER_BUDGET), "over_budget");
  EXPECT_EQ(report_status_name(INSITU_ERROR_COMM), "comm");
  EXPECT_EQ(report_status_name(-1), "unknown");
  EXPECT_EQ(report_status_name(11), "unknown");
}

// "seconds.build", "effects[].name", ...: every number or text of a line.
void collect_members(const ordered_json& json, const std::string& prefix, std::set<std::string>& members) {
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) {
      collect_members(value, prefix.empty() ? key : prefix + '.' + key, members);
    }
  } else if (json.is_array()) {
    for (const auto& value : json) collect_members(value, prefix + "[]", members);
  } else {
    members.insert(prefix);
  }
}

TEST(Report, ThePageListsExactlyTheMembers) {
  std::set<std::string> members;
  collect_members(ordered_json::parse(to_json_line(full_report())), "", members);
  EXPECT_EQ(members.size(), 29u);

  std::ifstream page(INSITU_REPORT_PAGE);
  ASSERT_TRUE(page) << INSITU_REPORT_PAGE;
  std::set<std::string> rows;  // first cells of the table: | `seconds.build` | ...
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("| `", 0) == 0) rows.insert(line.substr(3, line.find('`', 3) - 3));
  }
  EXPECT_EQ(rows, members);
}

}  // namespace
}  // namespace insitu
