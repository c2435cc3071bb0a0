#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "read_files.h"
#include "sample_files.h"

namespace replay::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsNan;

void expect_sample(const Frame& frame) {
  ASSERT_EQ(frame.count(), 4u);
  EXPECT_EQ(frame.time, 0.5);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(frame.position[i], static_cast<double>(i));
    EXPECT_EQ(values(frame, "velocity")[i], -static_cast<double>(i));
  }
  EXPECT_THAT(values(frame, "type"), ElementsAre(0, 1, 1, 4));
  EXPECT_THAT(values(frame, "mass"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(values(frame, "density"), ElementsAre(1.25, IsNan(), IsNan(), IsNan()));
  EXPECT_THAT(values(frame, "temperature"), ElementsAre(1.5, IsNan(), IsNan(), IsNan()));
  EXPECT_THAT(values(frame, "smoothing_length"), ElementsAre(1.75, IsNan(), IsNan(), IsNan()));
  EXPECT_THAT(values(frame, "metallicity"), ElementsAre(2, IsNan(), IsNan(), 4.25));
  EXPECT_THAT(values(frame, "formation_time"), ElementsAre(IsNan(), IsNan(), IsNan(), 4.5));
  EXPECT_THAT(values(frame, "softening"), ElementsAre(IsNan(), 2.25, 3.25, 4.75));
  EXPECT_THAT(values(frame, "potential"), ElementsAre(2.25, 2.5, 3.5, 5));
}

TEST(Tipsy, StandardAndNativeWithAndWithoutPadding) {
  Folder folder;
  for (const std::endian order : {std::endian::big, std::endian::little}) {
    for (const bool padding : {true, false}) {
      for (const int wide : {0, 1, 2}) {
        SCOPED_TRACE(::testing::Message() << padding << wide);
        const std::string text = tipsy_sample({order, padding, wide > 0, wide > 1});
        const std::string path = folder.write("file", text);
        EXPECT_EQ(detect_format(path), Format::tipsy);
        const std::vector<Frame> frames = read_all(path);
        ASSERT_EQ(frames.size(), 1u);
        expect_sample(frames[0]);
        EXPECT_EQ(frames[0].find("velocity")->scalars.index(), wide > 1 ? 0u : 1u);
        expect_sample(read_all(folder.write_gz("file.gz", text))[0]);
      }
    }
  }
}

TEST(Tipsy, SizesThatDoNotFitTheHeader) {
  Folder folder;
  const std::string text = tipsy_sample({});
  EXPECT_EQ(text.size(), 32u + 48 + 2 * 36 + 44);
  EXPECT_EQ(error_of(folder.write("file", text + "x")),
            "file: has 197 bytes, expected 196 by the counts of its header");
  EXPECT_EQ(error_of(folder.write_gz("file.gz", text.substr(0, 180))),
            "file.gz: has 180 bytes, expected 196 by the counts of its header");
}

}  // namespace
}  // namespace replay::test
