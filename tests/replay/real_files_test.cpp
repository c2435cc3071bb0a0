// Files as programs and data banks write them. Where they are: INSITU_DATA, or shared/data beside the source folder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "read_files.h"

namespace replay::test {
namespace {

class RealFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("INSITU_DATA");
    folder_ = folder ? folder : INSITU_SOURCE_DIR "/../shared/data";
    if (!std::filesystem::is_directory(folder_)) GTEST_SKIP() << "no data in " << folder_ << " (see INSITU_DATA)";
  }

  // Counts the frames, and checks that each has `count` particles at finite places.
  std::size_t frames_of(const std::string& name, std::size_t count) {
    const auto reader = open_reader(folder_ + "/" + name, {});
    std::size_t frames = 0;
    Frame frame;
    while (reader->next(frame)) {
      ++frames;
      EXPECT_EQ(frame.count(), count) << name << ", frame " << frames;
      EXPECT_TRUE(std::all_of(frame.position.begin(), frame.position.end(), [](double x) { return std::isfinite(x); }));
      for (const Attribute& a : frame.attributes) EXPECT_EQ(a.size(), a.components * count) << name << a.name;
    }
    return frames;
  }
  Frame first(const std::string& name) {
    Frame frame;
    open_reader(folder_ + "/" + name, {})->next(frame);
    return frame;
  }

  std::string folder_;
};

TEST_F(RealFiles, LammpsData) {
  EXPECT_EQ(frames_of("particles/lammps_nylon66_melt.data.gz", 35200), 1u);
  EXPECT_EQ(frames_of("particles/lammps_sigma5_gb.data.gz", 25600), 1u);
  EXPECT_EQ(frames_of("particles/lammps_powerlaw_spheres.data.gz", 10000), 1u);
  EXPECT_EQ(frames_of("particles/lammps_fluorographene.data.gz", 17280), 1u);
  EXPECT_EQ(frames_of("particles/lammps_Al2O3.data", 2160), 1u);
  EXPECT_EQ(frames_of("particles/lammps_SiC_eff.data.gz", 5000), 1u);
  EXPECT_EQ(frames_of("particles/lammps_Cu_aSiO2.data.gz", 4126), 1u);
  EXPECT_EQ(frames_of("particles/lammps_quartz.data", 9), 1u);
  EXPECT_EQ(frames_of("particles/lammps_peptide.data", 2004), 1u);
  EXPECT_EQ(frames_of("particles/lammps_sph_water_collapse.data.gz", 15702), 1u);
  EXPECT_EQ(frames_of("particles/lammps_cnt_film.data.gz", 79596), 1u);
}

TEST_F(RealFiles, LammpsDataStyles) {
  const Frame film = first("particles/lammps_cnt_film.data.gz");
  EXPECT_EQ(values(film, "radius")[0], 6.785);
  EXPECT_EQ(film.position[1], 2274.63);
  EXPECT_EQ(film.find("element"), nullptr);

  const Frame spheres = first("particles/lammps_powerlaw_spheres.data.gz");
  EXPECT_EQ(values(spheres, "radius")[0], 27.0148 / 2);
  EXPECT_EQ(spheres.step, 400000u);

  const Frame nylon = first("particles/lammps_nylon66_melt.data.gz");
  const std::vector<double> elements = values(nylon, "element");
  for (const double z : {1.0, 6.0, 7.0, 8.0}) EXPECT_GT(std::count(elements.begin(), elements.end(), z), 0) << z;
  EXPECT_EQ(values(nylon, "velocity").size(), 3 * nylon.count());

  EXPECT_NE(first("particles/lammps_fluorographene.data.gz").find("q"), nullptr);
  EXPECT_NE(first("particles/lammps_sph_water_collapse.data.gz").find("rho"), nullptr);
  const std::vector<double> silicon_carbide = values(first("particles/lammps_SiC_eff.data.gz"), "element");
  EXPECT_EQ(std::count(silicon_carbide.begin(), silicon_carbide.end(), 14.0), 500);
  EXPECT_EQ(std::count(silicon_carbide.begin(), silicon_carbide.end(), 1.0), 0) << "electrons are no hydrogen";
}

TEST_F(RealFiles, LammpsDumps) {
  EXPECT_EQ(frames_of("particles/lammps_spce.lammpstrj.gz", 4500), 11u);
  EXPECT_EQ(frames_of("particles/lammps_polymer.lammpstrj.gz", 1714), 42u);
  EXPECT_EQ(frames_of("particles/lammps_properties.lammpstrj.gz", 4000), 4u);
}

TEST_F(RealFiles, ScaledPositionsOfADumpAreItsPositions) {
  const Frame frame = first("particles/lammps_spce.lammpstrj.gz");
  const char* const scaled[3] = {"xs", "ys", "zs"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<double> s = values(frame, scaled[axis]);
    for (std::size_t i = 0; i < frame.count(); ++i) {
      const double x = frame.box.origin[axis] + s[i] * frame.box.edge[axis][axis];
      EXPECT_NEAR(frame.position[3 * i + axis], x, 1e-3);
    }
  }
}

TEST_F(RealFiles, Xyz) { EXPECT_EQ(frames_of("particles/xyz_water.xyz.gz", 297), 100u); }

TEST_F(RealFiles, Pdb) {
  EXPECT_EQ(frames_of("molecules/1crn.pdb", 327), 1u);
  EXPECT_EQ(frames_of("molecules/1tii.pdb.gz", 5684), 1u);
  EXPECT_EQ(frames_of("molecules/1m4x_pbcv1.pdb.gz", 9693), 1u);
  EXPECT_EQ(frames_of("molecules/2hkb_10models.pdb.gz", 757), 10u);
  EXPECT_EQ(frames_of("molecules/6vxx.pdb.gz", 23694), 1u);
  EXPECT_EQ(frames_of("molecules/5pti.pdb.gz", 1104 - 17), 1u) << "17 atoms have a second location";
  EXPECT_EQ(frames_of("particles/gromacs_cobrotoxin.pdb.gz", 19385), 1u);
}

TEST_F(RealFiles, PdbAndMmcifOfOneEntryAgree) {
  const Frame pdb = first("molecules/4hhb.pdb.gz");
  const Frame cif = first("molecules/4hhb.cif.gz");
  EXPECT_EQ(pdb.count(), 4779u);
  EXPECT_EQ(pdb.position, cif.position);
  for (const char* name : {"element", "bfactor", "occupancy", "residue", "hetatm"}) {
    EXPECT_EQ(values(pdb, name), values(cif, name)) << name;
  }
}

TEST_F(RealFiles, Mmcif) {
  EXPECT_EQ(frames_of("molecules/1ake.cif.gz", 3816 - 12), 1u) << "12 atoms have a second location";
  EXPECT_EQ(frames_of("molecules/4v5a.cif.gz", 290487), 1u);
}

TEST_F(RealFiles, Crystals) {
  // Faujasite has 192 tetrahedra and 384 oxygen atoms in its cell, ZSM-5 96 and 192.
  EXPECT_EQ(frames_of("molecules/zeolite_FAU.cif", 576), 1u);
  EXPECT_EQ(frames_of("molecules/zeolite_MFI.cif", 288), 1u);
  // Quartz has a hexagonal cell of three formula units, corundum as given here a rhombohedral one of two.
  EXPECT_EQ(frames_of("molecules/crystal_SiO2-Quartz-alpha.cif", 9), 1u);
  EXPECT_EQ(frames_of("molecules/crystal_Al2O3-Corundum.cif", 10), 1u);
  EXPECT_EQ(frames_of("molecules/crystal_SiC-3C-beta.cif", 8), 1u);
}

}  // namespace
}  // namespace replay::test
