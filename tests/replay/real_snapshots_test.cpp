// Snapshots and trajectories as programs write them. Where they are: INSITU_DATA, or shared/data beside the source
// folder. The numbers come from NumPy and h5py, which read the same files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "read_files.h"

namespace replay::test {
namespace {

class RealSnapshots : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("INSITU_DATA");
    folder_ = folder ? folder : INSITU_SOURCE_DIR "/../shared/data";
    if (!std::filesystem::is_directory(folder_)) GTEST_SKIP() << "no data in " << folder_ << " (see INSITU_DATA)";
  }
  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  Frame first(const std::string& name) const {
    Frame frame;
    open_reader(path(name), {})->next(frame);
    return frame;
  }

  std::string folder_;
};

double sum(const std::vector<double>& values, std::size_t first = 0, std::size_t stride = 1) {
  double sum = 0.0;
  for (std::size_t i = first; i < values.size(); i += stride) sum += values[i];
  return sum;
}

// Sums of the values as they are in the file; only the additions round.
void expect_near(double is, double expected) { EXPECT_NEAR(is, expected, 1e-9 * std::abs(expected)); }

TEST_F(RealSnapshots, OneSimulationInTwoFormatsAgrees) {
  const Frame tipsy = first("cosmology/changa_cube300.tbin.gz");
  const Frame hdf5 = first("cosmology/changa_cube300_gadget.hdf5");
  ASSERT_EQ(tipsy.count(), 48u * 48 * 48);
  ASSERT_EQ(hdf5.count(), tipsy.count());
  EXPECT_EQ(tipsy.time, 0.05);
  EXPECT_EQ(hdf5.time, 0.05);
  EXPECT_EQ(values(tipsy, "mass"), values(hdf5, "mass"));
  EXPECT_EQ(values(tipsy, "velocity"), values(hdf5, "velocity"));
  // TIPSY's box goes from -1/2 to 1/2, Gadget's from 0 to 300 Mpc, into which all was wrapped.
  const double box = hdf5.box.edge[0][0];
  EXPECT_EQ(box, 300.0);
  double off = 0.0;
  for (std::size_t i = 0; i < tipsy.position.size(); ++i) {
    const double place = (tipsy.position[i] + 0.5) * box;
    const double apart = std::abs(place - hdf5.position[i]);
    off = std::max(off, std::min(apart, std::abs(apart - box)));
  }
  EXPECT_LT(off, 1e-4) << "floats near 300 are 3e-5 apart";
}

TEST_F(RealSnapshots, Tipsy) {
  const Frame frame = first("cosmology/changa_galaxies_run581.tipsy");
  ASSERT_EQ(frame.count(), 3627u + 5321u);
  EXPECT_NEAR(frame.time.value_or(0), 0.1, 1e-12);
  const std::vector<double> type = values(frame, "type");
  EXPECT_EQ(std::count(type.begin(), type.end(), 1.0), 3627);
  EXPECT_EQ(std::count(type.begin(), type.end(), 4.0), 5321);
  expect_near(sum(values(frame, "mass")), 42903.22297672741);
  expect_near(sum(frame.position, 0, 3), 507.62888895659853);
  expect_near(sum(values(frame, "velocity"), 2, 3), 1414.9164096261375);
  expect_near(sum(values(frame, "softening")), 8.272799945814768);
  expect_near(sum(values(frame, "potential")), -196251415.08398438);
}

TEST_F(RealSnapshots, GadgetBinary) {
  const Frame planet = first("cosmology/planetsim_gadget1_sph_sphere.gadget.gz");
  ASSERT_EQ(planet.count(), 50000u);
  expect_near(sum(planet.position, 0, 3), 44342211798.87012);
  expect_near(sum(planet.position, 2, 3), -34916447971.06946);
  EXPECT_EQ(sum(values(planet, "velocity")), 0.0);
  EXPECT_EQ(sum(values(planet, "id")), 8929210793881.0);
  EXPECT_EQ(values(planet, "id")[0], 200040575.0);
  expect_near(sum(values(planet, "mass")), 5.982546405556684e+26);
  expect_near(sum(values(planet, "internal_energy")), 1221771237502.0);
  expect_near(sum(values(planet, "density")), 221036.4846574068);
  expect_near(sum(values(planet, "smoothing_length")), 2088310237474.0);
  expect_near(sum(values(planet, "block_8")), -7366691292905472.0);

  const Frame impact = first("cosmology/planetsim_gadget1_impact_ic.gadget.gz");
  ASSERT_EQ(impact.count(), 99974u);
  expect_near(sum(impact.position, 2, 3), 55134.81773376465);
  expect_near(sum(values(impact, "velocity"), 0, 3), -1469608.46875);
  EXPECT_EQ(sum(values(impact, "id")), 27780620445109.0);
  expect_near(sum(values(impact, "mass")), 3.544223127618387e+23);
  EXPECT_EQ(impact.find("density"), nullptr) << "initial conditions end with the internal energy";
}

// The volumes of SPH particles fill the planet: (4/3) pi R^3 by its outermost particles, 336500 km from the middle.
TEST_F(RealSnapshots, RadiiOfAPlanetFillIt) {
  const Frame planet = first("cosmology/planetsim_gadget1_sph_sphere.gadget.gz");
  double volume = 0.0;
  for (const double r : values(planet, "radius")) volume += 8 * r * r * r;
  const double whole = 4.0 / 3.0 * std::acos(-1.0) * std::pow(3.365e8, 3);
  EXPECT_NEAR(volume / whole, 1.0, 0.1);
}

TEST_F(RealSnapshots, Hdf5OfCoordinatesAlone) {
  const Frame halo = first("cosmology/sphviewer_dm_halo.hdf5");
  ASSERT_EQ(halo.count(), 174312u);
  expect_near(sum(halo.position, 0, 3), 713.8084786326931);
  expect_near(sum(halo.position, 1, 3), 1149.8807105346184);
  EXPECT_NEAR(halo.position.back(), -0.00029488, 1e-8);
}

TEST_F(RealSnapshots, Gro) {
  const Frame proteasome = first("molecules/3l5q_proteasome.gro.gz");
  ASSERT_EQ(proteasome.count(), 79452u);
  // Sums of the columns, in nm.
  EXPECT_NEAR(sum(proteasome.position, 0, 3), 10 * -37845.869, 1e-3);
  EXPECT_NEAR(sum(proteasome.position, 2, 3), 10 * -1523350.565, 1e-3);
  const auto atoms = [](const Frame& frame, double z) {
    const std::vector<double> elements = values(frame, "element");
    return std::count(elements.begin(), elements.end(), z);
  };
  EXPECT_EQ(atoms(proteasome, 6), 50608);
  EXPECT_EQ(atoms(proteasome, 7), 13364);
  EXPECT_EQ(atoms(proteasome, 8), 15178);
  EXPECT_EQ(atoms(proteasome, 16), 302);

  const Frame membrane = first("particles/gromacs_popc_membrane.gro.gz");
  ASSERT_EQ(membrane.count(), 63565u);
  EXPECT_EQ(atoms(membrane, 11), 39) << "sodium";
  EXPECT_EQ(atoms(membrane, 17), 39) << "chloride";
  EXPECT_EQ(atoms(membrane, 15), 194) << "one phosphorus per lipid";
  EXPECT_EQ(atoms(membrane, 8), 12497 + 1552) << "water and lipids";

  const Frame water = first("particles/gromacs_waterbox_bigbox.gro.gz");
  ASSERT_EQ(water.count(), 132303u);
  EXPECT_EQ(atoms(water, 1), 2 * atoms(water, 8));
}

TEST_F(RealSnapshots, DcdMovesThePdb) {
  ReadOptions options;
  options.trajectories = {path("particles/namd_adk_dims.dcd")};
  const std::vector<Frame> frames = read_all(path("particles/namd_adk_closed.pdb.gz"), options);
  ASSERT_EQ(frames.size(), 98u);
  const double first_sums[3] = {-141.11989226844162, 47.38192833447829, -117.09782430506311};
  const double last_sums[3] = {424.7659506453201, -823.5735890295473, -57.600010292138904};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sum(frames.front().position, axis, 3), first_sums[axis], 1e-9);
    EXPECT_NEAR(sum(frames.back().position, axis, 3), last_sums[axis], 1e-9);
  }
  EXPECT_EQ(frames.front().step, 1000u);
  EXPECT_EQ(frames.back().step, 98000u);
  // Were names and positions paired wrongly, hydrogen would not sit at 1 Angstrom from the atom before it.
  for (const Frame* frame : {&frames.front(), &frames.back()}) {
    const std::vector<double> element = values(*frame, "element");
    const double* const p = frame->position.data();
    EXPECT_EQ(element[0], 7);
    EXPECT_EQ(element[1], 1);
    EXPECT_NEAR(std::hypot(p[3] - p[0], p[4] - p[1], p[5] - p[2]), 1.04, 0.06);
  }
}

}  // namespace
}  // namespace replay::test
