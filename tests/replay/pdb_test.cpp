#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "read_files.h"

namespace replay::test {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::Pointwise;

// One record with the columns where the format has them.
std::string atom(const char* record, int serial, const char* name, char location, const char* residue, char chain,
                 int number, double x, const char* element) {
  char line[100];
  std::snprintf(line, sizeof line, "%-6s%5d %-4s%c%3s %c%4d    %8.3f%8.3f%8.3f%6.2f%6.2f          %2s\n", record,
                serial, name, location, residue, chain, number, x, 2.0, -3.5, 0.5, 12.25, element);
  return line;
}

const std::string two_atoms =
    atom("ATOM", 1, " N", ' ', "ALA", 'A', 7, 1.0, "N") + atom("HETATM", 2, "FE", ' ', "HEM", 'B', 1, 4.0, "FE");

TEST(Pdb, ReadsAtomsAndTheirAttributes) {
  Folder folder;
  const auto frames = read_all(folder.write("a.pdb", two_atoms));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_THAT(frames[0].position, ElementsAre(1, 2, -3.5, 4, 2, -3.5));
  EXPECT_THAT(values(frames[0], "element"), ElementsAre(7, 26));
  EXPECT_THAT(values(frames[0], "id"), ElementsAre(1, 2));
  EXPECT_THAT(values(frames[0], "bfactor"), ElementsAre(12.25, 12.25));
  EXPECT_THAT(values(frames[0], "occupancy"), ElementsAre(0.5, 0.5));
  EXPECT_THAT(values(frames[0], "chain"), ElementsAre(1, 2));
  EXPECT_THAT(values(frames[0], "residue"), ElementsAre(7, 1));
  EXPECT_THAT(values(frames[0], "hetatm"), ElementsAre(0, 1));
  EXPECT_FALSE(frames[0].box.known);
}

TEST(Pdb, CanLeaveOutLigandsAndWater) {
  Folder folder;
  ReadOptions options;
  options.hetatm = false;
  EXPECT_EQ(read_all(folder.write("a.pdb", two_atoms), options)[0].count(), 1u);
}

TEST(Pdb, OfAlternativeLocationsTheFirstCounts) {
  Folder folder;
  const auto frames = read_all(folder.write("a.pdb", atom("ATOM", 1, " N", ' ', "SER", 'A', 7, 1.0, "N") +
                                                         atom("ATOM", 2, " CA", 'B', "SER", 'A', 7, 2.0, "C") +
                                                         atom("ATOM", 3, " CA", 'C', "SER", 'A', 7, 3.0, "C") +
                                                         atom("ATOM", 4, " CB", 'C', "SER", 'A', 7, 4.0, "C")));
  EXPECT_THAT(values(frames[0], "id"), ElementsAre(1, 2, 4));
}

TEST(Pdb, OfAlternativeResiduesTheFirstCounts) {
  Folder folder;
  const auto frames = read_all(folder.write("a.pdb", atom("ATOM", 1, " CA", 'A', "SER", 'A', 7, 1.0, "C") +
                                                         atom("ATOM", 2, " OG", 'A', "SER", 'A', 7, 2.0, "O") +
                                                         atom("ATOM", 3, " CA", 'B', "THR", 'A', 7, 3.0, "C") +
                                                         atom("ATOM", 4, " CG2", 'B', "THR", 'A', 7, 4.0, "C") +
                                                         atom("ATOM", 5, " N", ' ', "GLY", 'A', 8, 5.0, "N")));
  EXPECT_THAT(values(frames[0], "id"), ElementsAre(1, 2, 5));
}

TEST(Pdb, ModelsAreSteps) {
  Folder folder;
  const std::string one = atom("ATOM", 1, " N", ' ', "ALA", 'A', 1, 1.0, "N");
  const auto frames = read_all(folder.write("a.pdb",
                                            "CRYST1   10.000   20.000   30.000  90.00  90.00  90.00 P 1\n"
                                            "MODEL        1\n" +
                                                one + "ENDMDL\nMODEL        2\n" + one + one + "ENDMDL\nEND\n"));
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].step, 1u);
  EXPECT_EQ(frames[1].step, 2u);
  EXPECT_EQ(frames[1].count(), 2u);
  EXPECT_THAT(frames[1].box.edge[2], Pointwise(DoubleNear(1e-12), {0.0, 0.0, 30.0}));
}

TEST(Pdb, ModelsMayBeMarkedByEndOrByTheNextModel) {
  Folder folder;
  const std::string one = atom("ATOM", 1, " N", ' ', "ALA", 'A', 1, 1.0, "N");
  EXPECT_EQ(read_all(folder.write("a.pdb", one + "END\n" + one + "END\n" + one)).size(), 3u);
  const auto frames = read_all(folder.write("b.pdb", "MODEL 4\n" + one + "MODEL 5\n" + one));
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].step, 5u);
}

TEST(Pdb, OddChargesDoNotMatter) {
  Folder folder;
  const std::string charged = two_atoms.substr(0, two_atoms.find('\n')) + "2x\n";
  EXPECT_THAT(values(read_all(folder.write("a.pdb", charged))[0], "element"), ElementsAre(7));
}

TEST(Pdb, ReadsWindowsLineEnds) {
  Folder folder;
  std::string text;
  for (const char c : two_atoms) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_THAT(values(read_all(folder.write("a.pdb", text))[0], "element"), ElementsAre(7, 26));
}

TEST(Pdb, ErrorsNameTheLine) {
  Folder folder;
  const auto error = [&](const std::string& text) { return error_of(folder.write("a.pdb", text)); };
  EXPECT_EQ(error("HEADER    NOTHING\nEND\n"), "a.pdb:2: the file ends here, expected \"ATOM\" or \"HETATM\" records");
  EXPECT_EQ(error("REMARK\n" + two_atoms.substr(0, 50) + "\n"),
            "a.pdb:2: an atom record of 50 characters, expected at least 54");
  std::string stars = two_atoms;
  stars.replace(38, 8, "********");
  EXPECT_EQ(error(stars), "a.pdb:1: \"********\" in the columns 39 to 46, expected the coordinate y");
}

}  // namespace
}  // namespace replay::test
