#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "read_files.h"

namespace replay::test {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::Pointwise;

std::string step(int number, const std::string& count, const std::string& bounds, const std::string& atoms) {
  return "ITEM: TIMESTEP\n" + std::to_string(number) + "\nITEM: NUMBER OF ATOMS\n" + count + "\nITEM: BOX BOUNDS " +
         bounds + "\nITEM: ATOMS " + atoms;
}
const std::string straight = "pp pp pp\n0 10\n-10 10\n5 10";

TEST(LammpsDump, ReadsStepsOfChangingOrderAndCount) {
  Folder folder;
  const auto frames =
      read_all(folder.write("a.dump", step(0, "2", straight, "id type x y z\n1 1 1 2 3\n2 2 4 5 6\n") +
                                          step(100, "3", straight, "id type x y z\n3 1 7 8 9\n2 2 4 5 6\n1 1 1 2 3\n") +
                                          step(200, "0", straight, "id type x y z\n")));
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].step, 0u);
  EXPECT_THAT(frames[0].position, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(frames[1].step, 100u);
  EXPECT_THAT(values(frames[1], "id"), ElementsAre(3, 2, 1));
  EXPECT_EQ(frames[2].count(), 0u);
  EXPECT_THAT(frames[1].box.origin, ElementsAre(0, -10, 5));
}

TEST(LammpsDump, TakesTheBestPositionsThatThereAre) {
  Folder folder;
  const auto first = [&](const std::string& atoms) {
    return read_all(folder.write("a.dump", step(0, "1", straight, atoms)))[0];
  };
  EXPECT_THAT(first("x y z\n1 2 6\n").position, ElementsAre(1, 2, 6));
  EXPECT_THAT(first("xu yu zu\n11 2 6\n").position, ElementsAre(11, 2, 6));
  EXPECT_THAT(first("xs ys zs\n0.25 0.75 0.5\n").position, ElementsAre(2.5, 5, 7.5));
  EXPECT_THAT(first("xsu ysu zsu\n1.5 0.5 0\n").position, ElementsAre(15, 0, 5));
  const Frame both = first("xs ys zs x y z\n0.25 0.75 0.5 1 2 6\n");
  EXPECT_THAT(both.position, ElementsAre(1, 2, 6));
  EXPECT_THAT(values(both, "ys"), ElementsAre(0.75));
}

TEST(LammpsDump, ScaledPositionsFollowATiltedBox) {
  Folder folder;
  // A box of lengths 10, 8, 6 with tilts 2, -1, 3: its bounding box is 11 wide along x and 11 along y.
  const auto frames = read_all(folder.write(
      "a.dump", step(0, "2", "xy xz yz pp pp pp\n-1 12 2\n0 11 -1\n0 6 3", "xs ys zs\n0 0 0\n0.5 0.5 0.5\n")));
  EXPECT_THAT(frames[0].box.origin, ElementsAre(0, 0, 0));
  EXPECT_THAT(frames[0].box.edge[0], ElementsAre(10, 0, 0));
  EXPECT_THAT(frames[0].box.edge[1], ElementsAre(2, 8, 0));
  EXPECT_THAT(frames[0].box.edge[2], ElementsAre(-1, 3, 6));
  EXPECT_THAT(frames[0].position, Pointwise(DoubleNear(1e-12), {0.0, 0.0, 0.0, 5.5, 5.5, 3.0}));
}

TEST(LammpsDump, ReadsAGeneralTriclinicBox) {
  Folder folder;
  const auto frames = read_all(
      folder.write("a.dump", step(0, "1", "abc origin pp pp pp\n1 2 3 -1\n4 5 6 -2\n7 8 10 -3", "x y z\n0 0 0\n")));
  EXPECT_THAT(frames[0].box.edge[1], ElementsAre(4, 5, 6));
  EXPECT_THAT(frames[0].box.origin, ElementsAre(-1, -2, -3));
}

TEST(LammpsDump, OtherColumnsBecomeAttributes) {
  Folder folder;
  const auto frames = read_all(folder.write("a.dump", step(0, "2", straight,
                                                           "element x y z vx vy vz c_s[1] radius f_a\n"
                                                           "O 0 0 0 3 4 0 -1.5 2 nan\nH 0 0 1 0 0 -2 2 1 0\n")));
  EXPECT_THAT(values(frames[0], "element"), ElementsAre(8, 1));
  EXPECT_THAT(values(frames[0], "c_s[1]"), ElementsAre(-1.5, 2));
  EXPECT_THAT(values(frames[0], "velocity"), ElementsAre(3, 4, 0, 0, 0, -2));
  EXPECT_THAT(values(frames[0], "speed"), ElementsAre(5, 2));
  EXPECT_THAT(values(frames[0], "radius"), ElementsAre(2, 1));
}

TEST(LammpsDump, TypesMayBeNames) {
  Folder folder;
  const std::string atoms = "id type x y z\n1 Na 0 0 0\n2 Cl 0 0 1\n";
  const auto frames = read_all(
      folder.write("a.dump", step(0, "2", straight, atoms) + step(1, "1", straight, "id type x y z\n2 Cl 0 0 1\n")));
  EXPECT_THAT(values(frames[0], "type"), ElementsAre(1, 2));
  EXPECT_THAT(values(frames[0], "element"), ElementsAre(11, 17));
  EXPECT_THAT(values(frames[1], "type"), ElementsAre(2));
}

TEST(LammpsDump, ColumnsMayChangeAndRepeat) {
  Folder folder;
  const auto frames = read_all(folder.write(
      "a.dump", step(0, "1", straight, "x y z q q\n0 0 0 1 2\n") + step(1, "1", straight, "x y z m\n0 0 0 5\n")));
  EXPECT_THAT(values(frames[0], "q"), ElementsAre(1));
  EXPECT_THAT(values(frames[1], "m"), ElementsAre(5));
  EXPECT_EQ(frames[1].find("q"), nullptr);
}

TEST(LammpsDump, ReadsUnitsAndTime) {
  Folder folder;
  const auto frames = read_all(
      folder.write("a.dump", "ITEM: UNITS\nlj\nITEM: TIME\n0.25\n" + step(5, "1", straight, "x y z\n0 0 0\n")));
  EXPECT_EQ(frames[0].time, 0.25);
}

TEST(LammpsDump, ErrorsNameTheLine) {
  Folder folder;
  const auto error = [&](const std::string& text) { return error_of(folder.write("a.dump", text)); };
  EXPECT_EQ(error(step(0, "2", straight, "x y z\n0 0 0\n")), "a.dump:10: the file ends here, expected atom 2 of 2");
  EXPECT_EQ(error(step(0, "2", straight, "x y z\n0 0 0\n") + "ITEM: TIMESTEP\n"),
            "a.dump:11: \"ITEM: TIMESTEP\", expected atom 2 of 2");
  EXPECT_EQ(error(step(0, "1", straight, "x y z\n0 0 0\n0 0 1\n")),
            "a.dump:11: \"0 0 1\", expected \"ITEM: ...\" (does the step before have more atoms than it says?)");
  EXPECT_EQ(error(step(0, "1", straight, "x y z\n0 0\n")), "a.dump:10: 2 columns, expected 3");
  EXPECT_EQ(error(step(0, "1", straight, "x y z\n0 a 0\n")), "a.dump:10: \"a\" in column \"y\", expected a number");
  EXPECT_EQ(error(step(0, "1", straight, "id x y\n1 0 0\n")),
            "a.dump:9: no columns with positions in \"ITEM: ATOMS id x y\", expected x y z, xu yu zu, xs ys zs or "
            "xsu ysu zsu");
  EXPECT_EQ(error(step(0, "many", straight, "x y z\n")), "a.dump:4: \"many\", expected the number of atoms");
  EXPECT_EQ(error(step(0, "1", "pp pp pp\n0 10\n0\n0 10", "x y z\n0 0 0\n")),
            "a.dump:7: \"0\" as bounds of the box, expected 2 numbers");
  EXPECT_EQ(error("ITEM: TIMESTEP\n0\n"), "a.dump:2: the file ends here, expected the next \"ITEM: ...\" of the step");
  EXPECT_EQ(error("ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS xs ys zs\n0 0 0\n"),
            "a.dump:5: scaled positions need \"ITEM: BOX BOUNDS\" before them");
  EXPECT_EQ(error("ITEM: TIMESTEP\n0\nITEM: ATOMS x y z\n0 0 0\n"),
            "a.dump:3: \"ITEM: ATOMS\" comes before \"ITEM: NUMBER OF ATOMS\"");
}

TEST(LammpsDump, ACountThatTheFileDoesNotHoldAllocatesNothing) {
  Folder folder;
  EXPECT_EQ(error_of(folder.write("a.dump", step(0, "9000000000000000000", straight, "x y z\n0 0 0\n"))),
            "a.dump:10: the file ends here, expected atom 2 of 9000000000000000000");
}

}  // namespace
}  // namespace replay::test
