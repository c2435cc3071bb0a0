#include "image/file_pattern.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace insitu {
namespace {

std::string expanded(const std::string& pattern, uint64_t step = 42, double time = 0.25) {
  const ExpandedPattern result = expand_pattern(pattern, step, time);
  EXPECT_TRUE(result.ok()) << result.error;
  return result.text;
}

TEST(FilePattern, Step) {
  EXPECT_EQ(expanded("frame.png"), "frame.png");
  EXPECT_EQ(expanded(""), "");
  EXPECT_EQ(expanded("frame_{step}.png"), "frame_42.png");
  EXPECT_EQ(expanded("frame_{step:6}.png"), "frame_000042.png");
  EXPECT_EQ(expanded("{step:1}"), "42");
  EXPECT_EQ(expanded("{step:2}"), "42");
  EXPECT_EQ(expanded("{step:20}"), "00000000000000000042");
  EXPECT_EQ(expanded("{step}/{step:4}.exr"), "42/0042.exr");
  EXPECT_EQ(expanded("{step}", 0), "0");
  EXPECT_EQ(expanded("{step:3}", std::numeric_limits<uint64_t>::max()), "18446744073709551615");
}

TEST(FilePattern, Time) {
  EXPECT_EQ(expanded("t{time}.png"), "t0.25.png");
  EXPECT_EQ(expanded("{time:4}"), "0.2500");
  EXPECT_EQ(expanded("{time:0}", 0, 12.75), "13");
  EXPECT_EQ(expanded("{time}", 0, 0.1), "0.1");
  EXPECT_EQ(expanded("{time}", 0, -1e-5), "-1e-05");
  EXPECT_EQ(expanded("{time:2}", 0, 1e300).size(), 304u);
  EXPECT_EQ(expanded("{time:17}", 0, -std::numeric_limits<double>::max()).size(), 328u);
  EXPECT_EQ(expanded("{time}", 0, std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(expanded("{time:3}", 0, std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(FilePattern, Braces) {
  EXPECT_EQ(expanded("{{step}}"), "{step}");
  EXPECT_EQ(expanded("{{{step}}}"), "{42}");
  EXPECT_EQ(expanded("a}}b{{"), "a}b{");
}

TEST(FilePattern, ErrorsNameThePatternAndTheKeys) {
  for (const char* pattern : {"{",
                              "}",
                              "a{step",
                              "{step}}",
                              "{}",
                              "{stp}",
                              "{Step}",
                              "{ step}",
                              "{step:}",
                              "{step:0}",
                              "{step:21}",
                              "{step:-3}",
                              "{step:+3}",
                              "{step: 3}",
                              "{step:3x}",
                              "{step:3:4}",
                              "{step:99999999999999999999}",
                              "{time:}",
                              "{time:18}",
                              "{time:-1}",
                              "{frame:4}",
                              "{{step}",
                              "x{{{step}}"}) {
    const ExpandedPattern result = expand_pattern(pattern, 1, 2.0);
    EXPECT_FALSE(result.ok()) << pattern;
    EXPECT_EQ(result.text, "") << pattern;
    EXPECT_NE(result.error.find(std::string("\"") + pattern + "\""), std::string::npos) << result.error;
    for (const char* key : {"{step}", "{step:N}", "{time}", "{time:N}"}) {
      EXPECT_NE(result.error.find(key), std::string::npos) << result.error;
    }
  }
  EXPECT_NE(expand_pattern("a_{frame:4}.png", 1, 2.0).error.find("unknown {frame:4}"), std::string::npos);
  EXPECT_NE(expand_pattern("a_{step.png", 1, 2.0).error.find("not closed"), std::string::npos);
}

}  // namespace
}  // namespace insitu
