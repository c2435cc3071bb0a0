#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "read_files.h"

namespace replay::test {
namespace {

using ::testing::HasSubstr;

TEST(Format, IsFoundByTheContent) {
  Folder folder;
  EXPECT_EQ(detect_format(folder.write("a", "title\n\n  12  atoms\n")), Format::lammps_data);
  EXPECT_EQ(detect_format(folder.write("b.data", "ITEM: TIMESTEP\n0\n")), Format::lammps_dump);
  EXPECT_EQ(detect_format(folder.write("c.txt", "3\ncomment\nO 0 0 0\n")), Format::xyz);
  EXPECT_EQ(detect_format(folder.write("d", "HEADER    OXYGEN TRANSPORT\n")), Format::pdb);
  EXPECT_EQ(detect_format(folder.write("e.xyz", "ATOM      1  N   ALA A   1\n")), Format::pdb);
  EXPECT_EQ(detect_format(folder.write("f", "# comment\n\ndata_1ABC\n")), Format::cif);
  EXPECT_EQ(detect_format(folder.write("h", "12 atoms\n1\n    1SOL     OW    1   0.126   1.624   1.679\n1 1 1\n")),
            Format::gro);
  EXPECT_EQ(detect_format(folder.write("i", "1\n1\nO 0.126 1.624 1.679\n")), Format::xyz);
  EXPECT_EQ(detect_format(folder.write("j", std::string_view("\x89HDF\r\n\x1A\n\0\0", 10))), Format::hdf5);
  EXPECT_EQ(detect_format(folder.write_gz("g", "ITEM: TIMESTEP\n0\n")), Format::lammps_dump);
}

TEST(Format, IsFoundByTheEndingWhereTheContentSaysNothing) {
  Folder folder;
  EXPECT_EQ(detect_format(folder.write("a.XYZ", "x\n")), Format::xyz);
  EXPECT_EQ(detect_format(folder.write_gz("a.lammpstrj.gz", "x\n")), Format::lammps_dump);
  EXPECT_EQ(detect_format(folder.write("a.ent", "x\n")), Format::pdb);
  EXPECT_EQ(detect_format(folder.write("a.gro", "x\n")), Format::gro);
  EXPECT_EQ(detect_format(folder.write("a.dcd", "x\n")), Format::dcd);
}

TEST(Format, IsAskedForOtherwise) {
  Folder folder;
  EXPECT_THAT(error_of(folder.write("a.txt", "hello\n")), HasSubstr("a.txt: the format is not known"));
  EXPECT_THAT(error_of(folder.write("b.xyz", std::string_view("\x89PNG\0\0", 6))),
              HasSubstr("b.xyz:1: the line holds binary"));
}

TEST(Format, NamesTheTrajectoriesThatAreNotRead) {
  Folder folder;
  EXPECT_THAT(error_of(folder.write("a.xtc", std::string_view("\0\0\7\xCB\0\0\0\1", 8))),
              HasSubstr("a.xtc: is a trajectory of GROMACS in the format XTC, which is not read here"));
  EXPECT_THAT(error_of(folder.write("a", std::string_view("\0\0\7\xC9\0\0\0\15", 8))), HasSubstr("format TRR"));
}

TEST(Format, CanBeForced) {
  Folder folder;
  ReadOptions options;
  options.format = Format::xyz;
  EXPECT_EQ(read_all(folder.write("a.txt", "1\nITEM: no item\nO 0 0 0\n"), options)[0].count(), 1u);
}

}  // namespace
}  // namespace replay::test
