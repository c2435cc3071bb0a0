#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "read_files.h"

namespace replay::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Xyz, ReadsPlainFiles) {
  Folder folder;
  const auto frames = read_all(folder.write("a.xyz", "2\na comment\nO 0 0 0.5\nH 1 0 0\n1\n\nH 2 0 0\n\n"));
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_THAT(frames[0].position, ElementsAre(0, 0, 0.5, 1, 0, 0));
  EXPECT_THAT(values(frames[0], "element"), ElementsAre(8, 1));
  EXPECT_THAT(values(frames[0], "type"), ElementsAre(1, 2));
  EXPECT_THAT(values(frames[1], "type"), ElementsAre(2)) << "types keep their numbers";
  EXPECT_EQ(frames[1].step, std::nullopt);
}

TEST(Xyz, NamesMayBeNumbersOrNoElements) {
  Folder folder;
  EXPECT_THAT(values(read_all(folder.write("a.xyz", "2\n\n8 0 0 0\n1 0 0 0\n"))[0], "element"), ElementsAre(8, 1));
  const auto frames = read_all(folder.write("b.xyz", "2\n\nbead 0 0 0\nwall 0 0 0\n"));
  EXPECT_EQ(frames[0].find("element"), nullptr);
  EXPECT_THAT(values(frames[0], "type"), ElementsAre(1, 2));
}

TEST(Xyz, FurtherColumnsAreKept) {
  Folder folder;
  EXPECT_THAT(values(read_all(folder.write("a.xyz", "1\n\nO 0 0 0 -0.8 7\n"))[0], "column_5"), ElementsAre(-0.8));
}

TEST(Xyz, ReadsExtendedFiles) {
  Folder folder;
  const auto frames = read_all(folder.write(
      "a.xyz",
      "2\nLattice=\"4 0 0 0 5 0 1 0 6\" Properties=species:S:1:pos:R:3:velo:R:3:q:R:1:frozen:L:1:tag:S:1 pbc=\"T T F\" "
      "Time=2.5 step=40\n"
      "Na 0 0 0 3 4 0 1 T left\nCl 1 2 3 0 0 1 -1 F right\n"));
  EXPECT_THAT(frames[0].position, ElementsAre(0, 0, 0, 1, 2, 3));
  EXPECT_THAT(values(frames[0], "element"), ElementsAre(11, 17));
  EXPECT_THAT(values(frames[0], "velocity"), ElementsAre(3, 4, 0, 0, 0, 1));
  EXPECT_THAT(values(frames[0], "speed"), ElementsAre(5, 1));
  EXPECT_THAT(values(frames[0], "q"), ElementsAre(1, -1));
  EXPECT_THAT(values(frames[0], "frozen"), ElementsAre(1, 0));
  EXPECT_THAT(values(frames[0], "tag"), ElementsAre(1, 2));
  EXPECT_THAT(frames[0].box.edge[2], ElementsAre(1, 0, 6));
  EXPECT_EQ(frames[0].time, 2.5);
  EXPECT_EQ(frames[0].step, 40u);
}

TEST(Xyz, PropertiesMayComeInAnyOrderAndBeLong) {
  Folder folder;
  const auto frames = read_all(folder.write("a.xyz",
                                            "1\nProperties=id:I:1:pos:R:3:Z:I:1:radius:R:1:stress:R:6\n"
                                            "9 1 2 3 26 0.5 1 2 3 4 5 6\n"));
  EXPECT_THAT(frames[0].position, ElementsAre(1, 2, 3));
  EXPECT_THAT(values(frames[0], "element"), ElementsAre(26));
  EXPECT_THAT(values(frames[0], "radius"), ElementsAre(0.5));
  EXPECT_THAT(values(frames[0], "stress[6]"), ElementsAre(6));
}

TEST(Xyz, NoParticlesAreAFrame) {
  Folder folder;
  const auto frames = read_all(folder.write("a.xyz", "0\nempty\n"));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_THAT(frames[0].position, IsEmpty());
}

TEST(Xyz, ErrorsNameTheLine) {
  Folder folder;
  const auto error = [&](const std::string& text) { return error_of(folder.write("a.xyz", text)); };
  EXPECT_EQ(error("2\n\nO 0 0 0\n"), "a.xyz:3: the file ends here, expected particle 2 of 2");
  EXPECT_EQ(error("2\n\nO 0 0 0\n\n"), "a.xyz:4: an empty line, expected particle 2 of 2");
  EXPECT_EQ(error("1\n\nO 0 0 0\nO 0 0 1\n"), "a.xyz:4: \"O 0 0 1\", expected the number of particles");
  EXPECT_EQ(error("1\n\nO 0 zero 0\n"), "a.xyz:3: \"zero\" in column \"y\", expected a number");
  EXPECT_EQ(error("1\n\nO 0 0\n"), "a.xyz:3: 3 columns, expected a name and x, y, z");
  EXPECT_EQ(error("2\n\nO 0 0 0\nO 0 0 0 0\n"), "a.xyz:4: 5 columns, expected 4");
  EXPECT_EQ(error("1\n"), "a.xyz:1: the file ends here, expected a comment line");
  EXPECT_EQ(error("1\nLattice=\"1 2 3\"\nO 0 0 0\n"), "a.xyz:2: Lattice=\"1 2 3\", expected nine numbers");
  EXPECT_EQ(error("1\nProperties=pos:R:2\n0 0\n"), "a.xyz:2: no property pos:R:3 in \"pos:R:2\"");
  EXPECT_EQ(error("1\nProperties=pos:R\n0 0 0\n"), "a.xyz:2: Properties=\"pos:R\", expected name:kind:count triples");
  EXPECT_EQ(error("1\nProperties=pos:X:3\n0 0 0\n"),
            "a.xyz:2: property \"pos:X:3\", expected a kind S, R, I or L and a number of columns");
  EXPECT_EQ(error("1\nProperties=pos:R:3:f:L:1\n0 0 0 maybe\n"), "a.xyz:3: \"maybe\" in column \"f\", expected T or F");
  EXPECT_EQ(error("-1\n\n"), "a.xyz:1: \"-1\", expected the number of particles");
  EXPECT_EQ(error("9000000000000000000\n\nO 0 0 0\n"),
            "a.xyz:3: the file ends here, expected particle 2 of 9000000000000000000");
}

}  // namespace
}  // namespace replay::test
