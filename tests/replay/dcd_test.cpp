#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "read_files.h"
#include "sample_files.h"

namespace replay::test {
namespace {

using ::testing::HasSubstr;

void expect_sample(const std::vector<Frame>& frames, const DcdSample& what) {
  ASSERT_EQ(frames.size(), 3u);
  for (std::size_t step = 0; step < 3; ++step) {
    const Frame& frame = frames[step];
    EXPECT_EQ(frame.step, 10 + 5 * step);
    EXPECT_NEAR(*frame.time, static_cast<double>(*frame.step) * 2 * 0.04888821, 1e-9);
    ASSERT_EQ(frame.count(), 4u);
    for (std::size_t atom = 0; atom < 4; ++atom) {
      const double moved = atom < static_cast<std::size_t>(what.fixed) ? 0.0 : static_cast<double>(step);
      const auto i = static_cast<double>(atom);
      EXPECT_EQ(frame.position[3 * atom], i + moved);
      EXPECT_EQ(frame.position[3 * atom + 1], 10 * i + moved);
      EXPECT_EQ(frame.position[3 * atom + 2], 100 * i + moved);
    }
    ASSERT_EQ(frame.box.known, what.charmm && what.cell);
    if (!frame.box.known) continue;
    EXPECT_EQ(frame.box.edge[0][0], 4.0);
    EXPECT_NEAR(frame.box.edge[1][0], 1.0, 1e-12);  // 2 at 60 degrees
    EXPECT_NEAR(frame.box.edge[1][1], std::sqrt(3.0), 1e-12);
    EXPECT_NEAR(frame.box.edge[2][2], 8.0, 1e-12);
  }
}

TEST(Dcd, EveryLayout) {
  Folder folder;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    for (const bool wide : {false, true}) {
      for (const bool charmm : {true, false}) {
        for (const bool cell : {true, false}) {
          for (const int fixed : {0, 1, 4}) {
            const DcdSample what = {order, wide, charmm, cell, cell, fixed};
            SCOPED_TRACE(::testing::Message() << wide << charmm << cell << fixed);
            const std::string path = folder.write("file", dcd_sample(what));
            EXPECT_EQ(detect_format(path), Format::dcd);
            expect_sample(read_all(path), what);
          }
        }
      }
    }
  }
  expect_sample(read_all(folder.write_gz("file.gz", dcd_sample({}))), {});
}

TEST(Dcd, DamagedFiles) {
  Folder folder;
  const std::string good = dcd_sample({});
  const auto changed = [&](std::size_t at, std::string_view bytes) {
    std::string text = good;
    text.replace(at, bytes.size(), bytes);
    return error_of(folder.write("file", text));
  };
  EXPECT_THAT(changed(4, "VELD"), HasSubstr("file: holds velocities"));
  EXPECT_THAT(changed(88, "\x53"), HasSubstr("the record of the header has 84 bytes by the number before it and 83"));
  const std::size_t atoms = 92 + 92 + 4;
  EXPECT_THAT(changed(atoms, "\x05"), HasSubstr("the record of the x coordinates has 16 bytes, expected 20"));
  EXPECT_THAT(changed(atoms, "\xFF\xFF\xFF\xFF"), HasSubstr("-1 atoms"));
  EXPECT_THAT(changed(atoms, "\xFF\xFF\xFF\x7F"), HasSubstr("has 16 bytes, expected 8589934588"));
  EXPECT_THAT(changed(4 + 36, "\x09"), HasSubstr("9 fixed atoms, expected 0 to 4"));
  EXPECT_THAT(error_of(folder.write("file", good.substr(0, good.size() - 1))), HasSubstr("the file ends too early"));
  const std::size_t header = 92 + 92 + 12;
  EXPECT_THAT(error_of(folder.write("file", good.substr(0, header))),
              HasSubstr("expected the positions of the first step"));
}

}  // namespace
}  // namespace replay::test
