#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "read_files.h"

namespace replay::test {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string columns = R"(data_TEST
# a comment
_entry.id TEST
_struct.title
;a text
of 'several lines
;
loop_
_atom_site.group_PDB
_atom_site.id
_atom_site.type_symbol
_atom_site.label_atom_id
_atom_site.label_alt_id
_atom_site.label_comp_id
_atom_site.label_asym_id
_atom_site.label_seq_id
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
_atom_site.occupancy
_atom_site.B_iso_or_equiv
_atom_site.auth_seq_id
_atom_site.auth_asym_id
_atom_site.pdbx_PDB_model_num
)";

TEST(Cif, ReadsMmcif) {
  Folder folder;
  const auto frames =
      read_all(folder.write("a.cif", columns + "ATOM 1 N N . ALA A 1 1.5 2 -3 1.0 20.5 7 X 1\n"
                                               "HETATM 2 C \"C5'\" . LIG B . 4 5 6 0.5 10 301 Y 1 #\n"));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_THAT(frames[0].position, ElementsAre(1.5, 2, -3, 4, 5, 6));
  EXPECT_THAT(values(frames[0], "element"), ElementsAre(7, 6));
  EXPECT_THAT(values(frames[0], "bfactor"), ElementsAre(20.5, 10));
  EXPECT_THAT(values(frames[0], "residue"), ElementsAre(7, 301));
  EXPECT_THAT(values(frames[0], "hetatm"), ElementsAre(0, 1));
  ReadOptions options;
  options.hetatm = false;
  EXPECT_EQ(read_all(folder.path("a.cif"), options)[0].count(), 1u);
}

TEST(Cif, ModelsAreSteps) {
  Folder folder;
  const auto frames = read_all(folder.write("a.cif", columns + "ATOM 1 N N . ALA A 1 1 2 3 1 20 7 X 1\n"
                                                               "ATOM 2 N N . ALA A 1 4 5 6 1 20 7 X 3\n"));
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].step, 1u);
  EXPECT_EQ(frames[1].step, 3u);
  EXPECT_THAT(frames[1].position, ElementsAre(4, 5, 6));
}

TEST(Cif, UnknownCoordinatesArePassedOn) {
  Folder folder;
  const auto frames = read_all(folder.write("a.cif", columns + "ATOM 1 N N . ALA A 1 ? 2 3 1 20 7 X 1\n"));
  EXPECT_TRUE(std::isnan(frames[0].position[0]));
}

const std::string crystal = R"(data_rock_salt
_cell_length_a 5.64(1)
_cell_length_b 5.64
_cell_length_c 5.64
_cell_angle_alpha 90
_cell_angle_beta 90
_cell_angle_gamma 90
_symmetry_space_group_name_H-M 'F m -3 m'
loop_
_atom_site_label
_atom_site_type_symbol
_atom_site_fract_x
_atom_site_fract_y
_atom_site_fract_z
Na1 Na+ 0 0 0
Cl1 Cl- 0.5(1) 0.5 0.5
)";

TEST(Cif, FillsTheUnitCellOfACrystal) {
  Folder folder;
  const auto frames = read_all(folder.write("a.cif", crystal));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_THAT(values(frames[0], "element"), ElementsAre(11, 11, 11, 11, 17, 17, 17, 17));
  EXPECT_THAT(values(frames[0], "site"), ElementsAre(1, 1, 1, 1, 2, 2, 2, 2));
  EXPECT_THAT(values(frames[0], "occupancy"), Each(1.0));
  EXPECT_NEAR(frames[0].box.edge[2][2], 5.64, 1e-12);
}

TEST(Cif, ListedSymmetryCountsBeforeTheSpaceGroup) {
  Folder folder;
  const auto frames =
      read_all(folder.write("a.cif", crystal + "loop_\n_symmetry_equiv_pos_as_xyz\n'x,y,z'\n'x+1/2,y+1/2,z'\n"));
  EXPECT_EQ(frames[0].count(), 4u);
}

TEST(Cif, ErrorsNameTheLine) {
  Folder folder;
  const auto error = [&](const std::string& text) { return error_of(folder.write("a.cif", text)); };
  EXPECT_EQ(error("data_x\n_cell.length_a 1\n"),
            "a.cif:2: the file ends here, expected a loop with _atom_site.Cartn_x (mmCIF) or _atom_site_fract_x "
            "(crystals)");
  EXPECT_EQ(error(columns + "ATOM 1 N N . ALA A 1 one 2 3 1 20 7 X 1\n"),
            "a.cif:25: \"one\" as _atom_site.Cartn_x, expected a number");
  EXPECT_EQ(error(columns + "ATOM 1 N N . ALA A 1 1 2 3 1 20 7 X\n"),
            "a.cif:25: the loop that starts in line 8 ends inside of a row, expected 16 values in each");
  EXPECT_THAT(error(columns), HasSubstr("a.cif:8: the loop of atoms has no rows"));
  EXPECT_EQ(error(columns + "ATOM 1 N N . ALA A 1 1 2 3 1 20 7_1 X 1\n"), "a.cif:8: not an integer: 7_");
  EXPECT_EQ(error("data_x\nloop_\n1 2 3\n"),
            "a.cif:3: \"loop_\" without tags, expected names such as \"_atom_site.Cartn_x\"");
  EXPECT_EQ(error("data_x\n_a 'not closed\n"), "a.cif:2: a value is not closed, expected '");
  EXPECT_EQ(error("data_x\n_a\n;text\n"),
            "a.cif:3: the file ends here, expected a line that starts with \";\" and closes the text");
  EXPECT_EQ(error("data_x\n_a\n"), "a.cif:2: the file ends here, expected the value of _a");
  EXPECT_EQ(error("data_x\n_a _b\n"), "a.cif:2: \"_b\", expected the value of _a");
  EXPECT_EQ(error("data_x\nvalue\n"), "a.cif:2: \"value\", expected a tag such as \"_cell.length_a\" or \"loop_\"");
  EXPECT_EQ(error("hello\n"), "a.cif:1: \"hello\", expected \"data_\" and a name");
}

}  // namespace
}  // namespace replay::test
