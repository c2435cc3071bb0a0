#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "read_files.h"

namespace replay::test {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* header = R"(LAMMPS data file, timestep = 250

2 atoms
2 atom types
-1 1 xlo xhi
-2 2 ylo yhi
-3 3 zlo zhi

)";

std::string data_file(const std::string& sections) { return header + sections; }

TEST(LammpsData, ReadsAtomsOfANamedStyle) {
  Folder folder;
  const auto frames = read_all(folder.write("a.data", data_file("Atoms # full\n\n"
                                                                "7 3 2 -0.5 1 2 3 0 0 -1 # comment\n"
                                                                "5 3 1 0.25 4 5 6 0 0 0\n")));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].step, 250u);
  EXPECT_THAT(frames[0].position, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(values(frames[0], "id"), ElementsAre(7, 5));
  EXPECT_THAT(values(frames[0], "mol"), ElementsAre(3, 3));
  EXPECT_THAT(values(frames[0], "type"), ElementsAre(2, 1));
  EXPECT_THAT(values(frames[0], "q"), ElementsAre(-0.5, 0.25));
  EXPECT_EQ(frames[0].find("element"), nullptr);
}

TEST(LammpsData, ReadsTheBox) {
  Folder folder;
  const std::string atoms = "Atoms # atomic\n\n1 1 0 0 0\n2 1 0 0 1\n";
  const auto straight = read_all(folder.write("a.data", data_file(atoms)));
  EXPECT_TRUE(straight[0].box.known);
  EXPECT_THAT(straight[0].box.origin, ElementsAre(-1, -2, -3));
  EXPECT_THAT(straight[0].box.edge[2], ElementsAre(0, 0, 6));
  const auto tilted = read_all(folder.write("b.data", data_file("0.5 0.25 0.125 xy xz yz\n\n" + atoms)));
  EXPECT_THAT(tilted[0].box.edge[1], ElementsAre(0.5, 4, 0));
  EXPECT_THAT(tilted[0].box.edge[2], ElementsAre(0.25, 0.125, 6));
}

TEST(LammpsData, GuessesTheStyleFromTheColumns) {
  Folder folder;
  const struct {
    const char* rows;
    const char* remark;
  } cases[] = {
      {"1 1 0.5 0 0\n2 1 0 0 1\n", "atomic"},
      {"1 1 0.5 0 0 0 0 0\n2 1 0 0 1 0 0 1\n", "atomic"},
      {"1 1 2 0.5 0 0\n2 1 1 0 0 1\n", "molecular"},
      {"1 1 0.0 0.5 0 0\n2 1 1.0 0 0 1\n", "charge"},
      {"1 2 0 0.5 0 0\n2 1 0 0 0 1\n", "charge"},  // type 0 does not exist, so the third column is no type
      {"1 1 2 0.1 0.5 0 0\n2 1 1 0 0 0 1\n", "full"},
      {"1 1 2 0.1 0.5 0 0 0 0 1\n2 1 1 0 0 0 1 0 0 0\n", "full"},
      {"1 1 27.01 1 0.5 0 0 0 0 1\n2 1 1.5 1 0 0 1 0 0 0\n", "sphere"},
      {"1 1 4.0 3 1.69 0.5 0 0\n2 2 0.0 1 1.5 0 0 1.5\n", "electron"},
      {"1 1 1000. 0.5 1. 0.5 0 0.\n2 2 1000. 0.5 1. 0.5 0 0.\n", "sph"},
      {"1 1 1 -1 2 976. 6.785 10 0 299.2 2274.6 9.7 0 0 0\n2 1 1 1 -1 976. 6.785 10 0 289.2 2274. 9.7 0 0 0\n",
       "mesont"},
  };
  for (const auto& c : cases) {
    const auto reader = open_reader(folder.write("a.data", data_file(std::string("Atoms\n\n") + c.rows)), {});
    Frame frame;
    ASSERT_TRUE(reader->next(frame)) << c.remark;
    EXPECT_EQ(frame.count(), 2u);
    EXPECT_EQ(reader->remark(), std::string("atom style ") + c.remark + " (guessed from the columns)") << c.rows;
  }
}

TEST(LammpsData, StyleCanBeGivenByTheCaller) {
  Folder folder;
  const std::string path = folder.write("a.data", data_file("Atoms\n\n1 1 2 0.5 0 0\n2 1 1 0 0 1\n"));
  ReadOptions options;
  options.atom_style = "charge";
  EXPECT_THAT(values(read_all(path, options)[0], "q"), ElementsAre(2, 1));
  options.atom_style = "wrong";
  EXPECT_THAT(error_of(path, options), HasSubstr("atom style \"wrong\" is not known, expected one of angle, atomic"));
}

TEST(LammpsData, HybridStylesAppendTheirColumns) {
  Folder folder;
  const auto frames = read_all(
      folder.write("a.data", data_file("Atoms # hybrid sphere charge\n\n1 1 0 0 0 3 1.5 -1\n2 2 0 0 1 4 1.5 1\n")));
  EXPECT_THAT(frames[0].position, ElementsAre(0, 0, 0, 0, 0, 1));
  EXPECT_THAT(values(frames[0], "diameter"), ElementsAre(3, 4));
  EXPECT_THAT(values(frames[0], "q"), ElementsAre(-1, 1));
}

TEST(LammpsData, DiametersBecomeRadii) {
  Folder folder;
  const auto frames = read_all(folder.write("a.data", data_file("Atoms # sphere\n\n1 1 3 1 0 0 0\n2 1 0.5 1 0 0 1\n")));
  EXPECT_THAT(values(frames[0], "radius"), ElementsAre(1.5, 0.25));
}

TEST(LammpsData, MassesNameElements) {
  Folder folder;
  const auto frames = read_all(folder.write(
      "a.data", data_file("Masses\n\n1 15.9994 # O\n2 1.008\n\nAtoms # atomic\n\n1 2 0 0 0\n2 1 0 0 1\n")));
  EXPECT_THAT(values(frames[0], "element"), ElementsAre(1, 8));
}

TEST(LammpsData, ElectronsHaveNoElement) {
  Folder folder;
  const auto frames = read_all(folder.write(
      "a.data",
      data_file("Masses\n\n1 28.0855\n2 1.0\n\nAtoms # electron\n\n1 1 4.0 3 1.69 0 0 0\n2 2 0.0 -1 1.5 0 0 1\n")));
  EXPECT_THAT(values(frames[0], "element"), ElementsAre(14, 0));
  EXPECT_THAT(values(frames[0], "radius"), ElementsAre(1.69, 1.5));
}

TEST(LammpsData, VelocitiesFollowTheIds) {
  Folder folder;
  const auto frames = read_all(folder.write("a.data", data_file("Atoms # atomic\n\n7 1 0 0 0\n5 1 0 0 1\n\n"
                                                                "Velocities\n\n5 3 4 0\n7 0 0 -1\n\n"
                                                                "Bonds\n\n1 1 7 5\n")));
  EXPECT_THAT(values(frames[0], "velocity"), ElementsAre(0, 0, -1, 3, 4, 0));
  EXPECT_THAT(values(frames[0], "speed"), ElementsAre(1, 5));
}

TEST(LammpsData, EllipsoidsBecomeSpheresOfTheirVolume) {
  Folder folder;
  const auto frames = read_all(folder.write("a.data",
                                            "title\n\n2 atoms\n1 ellipsoids\n1 atom types\n\n"
                                            "Atoms # ellipsoid\n\n1 1 1 1.0 0 0 0\n2 1 0 1.0 0 0 1\n\n"
                                            "Ellipsoids\n\n1 1 2 4 1 0 0 0\n"));
  EXPECT_THAT(values(frames[0], "radius"), ElementsAre(1, 0));
  EXPECT_FALSE(frames[0].box.known);
}

TEST(LammpsData, TypesMayHaveLabels) {
  Folder folder;
  const auto frames = read_all(folder.write("a.data", data_file("Atom Type Labels\n\n1 O\n2 H\n\n"
                                                                "Masses\n\nO 15.9994\nH 1.008\n\n"
                                                                "Atoms # atomic\n\n1 H 0 0 0\n2 O 0 0 1\n")));
  EXPECT_THAT(values(frames[0], "type"), ElementsAre(2, 1));
  EXPECT_THAT(values(frames[0], "element"), ElementsAre(1, 8));
}

TEST(LammpsData, NotANumberIsPassedOn) {
  Folder folder;
  const auto frames = read_all(folder.write("a.data", data_file("Atoms # atomic\n\n1 1 nan 0 0\n2 1 0 0 1\n")));
  EXPECT_TRUE(std::isnan(frames[0].position[0]));
}

TEST(LammpsData, ReadsWindowsLineEndsAndNoAtoms) {
  Folder folder;
  EXPECT_EQ(
      read_all(folder.write("a.data", "t\r\n\r\n1 atoms\r\n1 atom types\r\n\r\nAtoms\r\n\r\n1 1 0 0 0\r\n"))[0].count(),
      1u);
  EXPECT_EQ(read_all(folder.write("b.data", "t\n\n0 atoms\n"))[0].count(), 0u);
}

TEST(LammpsData, ErrorsNameTheLine) {
  Folder folder;
  const auto error = [&](const std::string& sections) { return error_of(folder.write("a.data", data_file(sections))); };
  EXPECT_EQ(error("Atoms # atomic\n\n1 1 0 0 0\n"), "a.data:11: the file ends here, expected row 2 of 2 of \"Atoms\"");
  EXPECT_EQ(error("Atoms # atomic\n\n1 1 0 0 0\n\nVelocities\n\n"),
            "a.data:13: \"Velocities\", expected row 2 of 2 of \"Atoms\"");
  EXPECT_EQ(error("Atoms # atomic\n\n1 1 0 abc 0\n2 1 0 0 0\n"),
            "a.data:11: \"abc\" in column \"y\", expected a number");
  EXPECT_EQ(error("Atoms # atomic\n\n1 1 0 0 0\n2 1 0 0\n"),
            "a.data:12: 4 columns, expected 5 or 8 for atom style atomic");
  EXPECT_EQ(error("Atoms # atomic\n\n1 3 0 0 0\n2 1 0 0 0\n"), "a.data:11: type 3, but the header says 2 atom types");
  EXPECT_EQ(error("Atoms # atomic\n\n1.5 1 0 0 0\n2 1 0 0 0\n"),
            "a.data:11: \"1.5\" in column \"id\", expected a whole number");
  EXPECT_EQ(error("Atoms # atomic\n\n1 1 0 0 0\n2 1 0 0 0\n\nVelocities\n\n1 0 0 0\n9 0 0 0\n"),
            "a.data:17: no atom has the id 9");
  EXPECT_EQ(error("Atoms\n\n1 1\n2 1\n"),
            "a.data:9: rows of 2 columns fit no atom style, expected a hint such as \"Atoms # full\" "
            "(or --atom-style)");
  EXPECT_EQ(error("Masses\n\n1 x\n"), "a.data:11: \"x\", expected a number");
  EXPECT_EQ(error("Masses\n\n1 1\n2 1\n"), "a.data:12: the file ends here, expected a section \"Atoms\"");
  EXPECT_EQ(error_of(folder.write("b.data", "title\n\n-4 atoms\n")), "b.data:3: \"-4\", expected the number of atoms");
  EXPECT_EQ(error_of(folder.write("c.data", "title\n\nAtoms\n\n")),
            "c.data:3: the number of atoms is missing above, expected \"N atoms\"");
  EXPECT_EQ(error_of(folder.write("d.data", "hello\nworld\n")),
            "d.data:2: \"world\", expected the header of a LAMMPS data file (\"N atoms\")");
  EXPECT_EQ(error_of(folder.write("e.data", "title\n\n1 atoms\n0 x xlo xhi\n")), "e.data:4: \"x\", expected a number");
}

TEST(LammpsData, ACountThatTheFileDoesNotHoldAllocatesNothing) {
  Folder folder;
  EXPECT_EQ(error_of(folder.write("a.data", "t\n\n9000000000000000000 atoms\n1 atom types\n\nAtoms\n\n1 1 0 0 0\n")),
            "a.data:8: the file ends here, expected row 2 of 9000000000000000000 of \"Atoms\"");
}

}  // namespace
}  // namespace replay::test
