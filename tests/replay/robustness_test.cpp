// Damaged files: whatever is cut off or changed, a reader yields frames that are whole, or throws InputError.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <iterator>

#include "input_error.h"
#include "read_files.h"
#include "sample_files.h"

namespace replay::test {
namespace {

struct Sample {
  const char* name;
  Format format;
  const char* text;
};

const std::array<Sample, 6> samples = {{
    {"data", Format::lammps_data,
     "title, timestep = 5\n\n3 atoms\n1 ellipsoids\n2 atom types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n"
     "1 0 0 xy xz yz\n\nAtom Type Labels\n\n1 C\n2 H\n\nMasses\n\nC 12.011\nH 1.008\n\nAtoms # full\n\n"
     "1 1 C -0.5 1 2 3 0 0 0\n2 1 H 0.25 4 5 6 0 0 1\n9 2 2 0.25 7 8 nan 0 -1 0 # last\n\n"
     "Velocities\n\n9 0 0 1\n1 1 0 0\n2 0 1 0\n\nEllipsoids\n\n9 1 2 3 1 0 0 0\n\nBonds\n\n1 1 1 2\n"},
    {"data without a hint", Format::lammps_data,
     "title\n\n2 atoms\n2 atom types\n\nAtoms\n\n1 1 2 0.1 0.5 0 0\n2 1 1 0 0 0 1.5\n"},
    {"dump", Format::lammps_dump,
     "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS xy xz yz pp pp pp\n0 9 1\n0 9 0\n0 9 0\n"
     "ITEM: ATOMS id type element xs ys zs vx vy vz q\n1 C C .1 .2 .3 1 1 1 5\n2 H H .4 .5 .6 0 0 0 6\n"
     "ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\n"
     "ITEM: ATOMS id x y z\n1 1 2 3\n"},
    {"xyz", Format::xyz,
     "2\nLattice=\"4 0 0 0 5 0 0 0 6\" Properties=species:S:1:pos:R:3:velo:R:3:on:L:1:tag:S:1 Time=1 step=2\n"
     "Na 0 0 0 1 1 1 T a\nCl 1 2 3 0 0 0 F b\n1\nplain\nO 1 2 3 4\n"},
    {"pdb", Format::pdb,
     "CRYST1   10.000   20.000   30.000  90.00  90.00  90.00 P 1           1\nMODEL        1\n"
     "ATOM      1  N  AALA A   7       1.000   2.000  -3.500  0.50 12.25           N\n"
     "ATOM      2  N  BALA A   7       1.500   2.000  -3.500  0.50 12.25           N\nTER\n"
     "HETATM    3 FE   HEM B   1       4.000   2.000  -3.500  1.00 12.25          FE2+\nENDMDL\nMODEL        2\n"
     "ATOM      1  N   ALA A   7       1.000   2.000  -3.500  0.50 12.25           N\nENDMDL\nEND\n"},
    {"cif", Format::cif,
     "data_X\n_cell.length_a 10\n_cell.length_b 10\n_cell.length_c 10\n_cell.angle_alpha 90\n_cell.angle_beta 90\n"
     "_cell.angle_gamma 90\n_s.t\n;text\n;\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.type_symbol\n"
     "_atom_site.label_atom_id\n_atom_site.label_alt_id\n_atom_site.label_comp_id\n_atom_site.label_asym_id\n"
     "_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n_atom_site.occupancy\n"
     "_atom_site.B_iso_or_equiv\n_atom_site.auth_seq_id\n_atom_site.pdbx_PDB_model_num\n"
     "ATOM 1 N N . ALA A 1 2 3 1 20 7 1\nHETATM 2 C \"C5'\" A LIG B 4 5 6 .5 10 301 1\nATOM 1 N N . ALA A 1 2 3 1 20 7 "
     "2\n"
     "data_Y\n"},
}};

const char* const gro =
    "Water t= 1.0 step= 5\n    2\n    1SOL     OW    1   0.126   1.624   1.679  0.1227 -0.0580  0.0434\n"
    "    1SOL    HW1    2   0.190   1.661   1.747  0.8085  0.3191 -0.7791\n   1.8   1.8   1.8\n"
    "t= 2.0\n    1\n    1LYS    1HB    1   1.00000   2.00000  -3.12345\n   3 4 5 0 0 1 0 1 2\n";

const char* const crystal =
    "data_X\n_cell_length_a 5\n_cell_length_b 5\n_cell_length_c 5\n_cell_angle_alpha 90\n_cell_angle_beta 90\n"
    "_cell_angle_gamma 90\nloop_\n_symmetry_equiv_pos_as_xyz\n'x,y,z'\n'-x,1/2+y,-z'\nloop_\n_atom_site_label\n"
    "_atom_site_type_symbol\n_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\nNa1 Na+ 0 0 0\nCl1 Cl- .5 .5 "
    ".5\n";

// True when the file could be read. The test fails when anything but InputError comes out.
bool reads(const std::string& path, Format format) {
  ReadOptions options;
  options.format = format;
  try {
    read_all(path, options);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

// The same sequence with every standard library.
class Random {
 public:
  explicit Random(std::uint32_t seed) : state_(seed * 2654435761u + 1u) {}
  std::uint32_t below(std::size_t bound) {
    state_ = state_ * 1664525u + 1013904223u;
    return static_cast<std::uint32_t>((state_ >> 8) % bound);
  }

 private:
  std::uint32_t state_;
};

void cut_everywhere(const Folder& folder, const char* name, Format format, std::string_view text) {
  EXPECT_TRUE(reads(folder.write("file", text), format)) << name;
  for (std::size_t length = 1; length < text.size(); length += 3) {
    ASSERT_NO_THROW(reads(folder.write("file", text.substr(0, length)), format)) << name << " cut at " << length;
  }
}

void change_everywhere(const Folder& folder, const char* name, Format format, std::string_view text) {
  constexpr std::string_view replacements = "0919.-+eE#;'\"_ \n\tnaNxX:{}\\\xFF";
  for (std::uint32_t seed = 0; seed < 500; ++seed) {
    Random random(seed);
    std::string damaged(text);
    for (std::uint32_t i = 0; i <= seed % 4; ++i) {
      damaged[random.below(damaged.size())] = replacements[random.below(replacements.size())];
    }
    if (seed % 5 == 0) damaged.erase(random.below(damaged.size()), 1 + random.below(20));
    ASSERT_NO_THROW(reads(folder.write("file", damaged), format)) << name << ", seed " << seed << '\n' << damaged;
  }
}

TEST(Robustness, FilesCutOffAnywhere) {
  Folder folder;
  for (const Sample& sample : samples) cut_everywhere(folder, sample.name, sample.format, sample.text);
  cut_everywhere(folder, "crystal", Format::cif, crystal);
  cut_everywhere(folder, "gro", Format::gro, gro);
}

TEST(Robustness, FilesWithWrongCharacters) {
  Folder folder;
  for (const Sample& sample : samples) change_everywhere(folder, sample.name, sample.format, sample.text);
  change_everywhere(folder, "crystal", Format::cif, crystal);
  change_everywhere(folder, "gro", Format::gro, gro);
}

struct BinarySample {
  const char* name;
  Format format;
  std::string content;
  int whole_beginnings;  // lengths, less than all, at which what is there is a file in itself
};

std::vector<BinarySample> binary_samples() {
  return {
      // Behind the masses nothing has to follow: the end may stand after MASS, U and RHO.
      {"gadget 1", Format::gadget, gadget_sample({}), 3},
      {"gadget 2, big-endian, doubles", Format::gadget, gadget_sample({std::endian::big, true, true}), 3},
      {"tipsy", Format::tipsy, tipsy_sample({}), 0},
      {"tipsy, native", Format::tipsy, tipsy_sample({std::endian::little, false}), 0},
      // Steps one by one.
      {"dcd", Format::dcd, dcd_sample({}), 2},
      {"dcd, big-endian, fixed atoms", Format::dcd, dcd_sample({std::endian::big, true, true, true, true, 1}), 2},
  };
}

TEST(Robustness, BinaryFilesCutOffAnywhere) {
  Folder folder;
  for (const BinarySample& sample : binary_samples()) {
    EXPECT_TRUE(reads(folder.write("file", sample.content), sample.format)) << sample.name;
    int whole = 0;
    for (std::size_t length = 1; length < sample.content.size(); ++length) {
      const std::string path = folder.write("file", std::string_view(sample.content).substr(0, length));
      ASSERT_NO_THROW(whole += reads(path, sample.format)) << sample.name << " cut at " << length;
    }
    EXPECT_EQ(whole, sample.whole_beginnings) << sample.name;
  }
}

TEST(Robustness, CompressedBinaryFilesCutOffAnywhere) {
  Folder folder;
  for (const BinarySample& sample : binary_samples()) {
    std::ifstream in(folder.write_gz("whole", sample.content), std::ios::binary);
    const std::string packed{std::istreambuf_iterator<char>(in), {}};
    int whole = 0;
    // The first two bytes are the mark of gzip, the last eight a check sum and the length.
    for (std::size_t length = 1; length + 8 < packed.size(); ++length) {
      const std::string path = folder.write("file", std::string_view(packed).substr(0, length));
      ASSERT_NO_THROW(whole += reads(path, sample.format)) << sample.name << " cut at " << length;
    }
    EXPECT_LE(whole, sample.whole_beginnings) << sample.name;
  }
}

TEST(Robustness, BinaryFilesWithWrongBytes) {
  Folder folder;
  for (const BinarySample& sample : binary_samples()) {
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
      Random random(seed);
      std::string damaged = sample.content;
      for (std::uint32_t i = 0; i <= seed % 3; ++i) {
        constexpr std::string_view bytes("\0\1\x7F\x80\xFF\x0C\x54\x08", 8);
        damaged[random.below(damaged.size())] = bytes[random.below(bytes.size())];
      }
      ASSERT_NO_THROW(reads(folder.write("file", damaged), sample.format)) << sample.name << ", seed " << seed;
    }
  }
}

TEST(Robustness, FilesReadAsAnotherFormat) {
  Folder folder;
  for (const Sample& sample : samples) {
    const std::string path = folder.write("file", sample.text);
    for (const Sample& other : samples) {
      const bool is_same = other.format == sample.format;
      EXPECT_EQ(reads(path, other.format), is_same) << sample.name << " as " << other.name;
    }
  }
}

}  // namespace
}  // namespace replay::test
