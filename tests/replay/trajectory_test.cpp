#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "read_files.h"
#include "sample_files.h"

namespace replay::test {
namespace {

using ::testing::ElementsAre;

std::string pdb_atom(int id, const char* name, const char* residue, int number, double x) {
  char line[100];
  std::snprintf(line, sizeof line, "ATOM  %5d %-4s %3s  %4d    %8.3f%8.3f%8.3f  1.00  0.00\n", id, name, residue,
                number, x, 0.0, 0.0);
  return line;
}

ReadOptions with(std::vector<std::string> trajectories) {
  ReadOptions options;
  options.trajectories = std::move(trajectories);
  return options;
}

// The second residue 1 is another one: the count began anew. Its atoms must stay behind those of residue 2.
const std::string topology = pdb_atom(1, "O", "SOL", 1, 1) + pdb_atom(2, "CA", "ALA", 2, 2) +
                             pdb_atom(3, "N", "SOL", 1, 3) + pdb_atom(4, "MW", "SOL", 1, 4);

TEST(Trajectory, MovesTheParticlesOfTheFile) {
  Folder folder;
  const std::string pdb = folder.write("top.pdb", topology);
  const std::vector<Frame> frames = read_all(pdb, with({folder.write("a.dcd", dcd_sample({}))}));
  ASSERT_EQ(frames.size(), 3u);
  for (const Frame& frame : frames) {
    EXPECT_THAT(values(frame, "element"), ElementsAre(8, 6, 7, -1));
    EXPECT_THAT(values(frame, "id"), ElementsAre(1, 2, 3, 4));
    EXPECT_TRUE(frame.box.known);
  }
  EXPECT_EQ(frames[2].step, 20u);
  EXPECT_EQ(frames[2].position[3], 1 + 2);
  EXPECT_EQ(frames[2].position[11], 300 + 2);
}

TEST(Trajectory, SeveralOneAfterTheOther) {
  Folder folder;
  const std::string dcd = folder.write("a.dcd", dcd_sample({}));
  EXPECT_EQ(read_all(folder.write("top.pdb", topology), with({dcd, dcd})).size(), 6u);
}

TEST(Trajectory, OtherCountsNameBothFiles) {
  Folder folder;
  const std::string pdb = folder.write("top.pdb", pdb_atom(1, "O", "SOL", 1, 1));
  const std::string dcd = folder.write("a.dcd", dcd_sample({}));
  EXPECT_EQ(error_of(pdb, with({dcd})), "a.dcd: has 4 particles in a step, expected 1 as \"top.pdb\" has");
}

TEST(Trajectory, DumpsAreMatchedByIdAndKeepTheirOwnValues) {
  Folder folder;
  const std::string data = folder.write(
      "a.data",
      "title\n\n2 atoms\n2 atom types\n\nMasses\n\n1 12.011\n2 1.008\n\nAtoms # atomic\n\n7 2 7 0 0\n3 1 3 0 0\n"
      "\nVelocities\n\n7 1 1 1\n3 1 1 1\n");
  const std::string dump =
      folder.write("a.dump",
                   "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n2\nITEM: ATOMS id x y z q\n7 70 0 0 .7\n3 30 0 "
                   "0 .3\nITEM: TIMESTEP\n6\nITEM: NUMBER OF ATOMS\n2\nITEM: ATOMS id x y z q\n3 31 0 0 "
                   ".3\n7 71 0 0 .7\n");
  const std::vector<Frame> frames = read_all(data, with({dump}));
  ASSERT_EQ(frames.size(), 2u);
  for (const Frame& frame : frames) {
    EXPECT_THAT(values(frame, "id"), ElementsAre(3, 7));
    EXPECT_THAT(values(frame, "element"), ElementsAre(6, 1));
    EXPECT_THAT(values(frame, "q"), ElementsAre(.3, .7));
    EXPECT_EQ(frame.find("velocity"), nullptr);
  }
  EXPECT_EQ(frames[1].position[0], 31);
}

}  // namespace
}  // namespace replay::test
