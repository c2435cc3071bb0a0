// One start, one trajectory, to the last bit: whatever the number of threads and the order of the records.
#include <gtest/gtest.h>

#include "states.h"

namespace melt {
namespace {

TEST(Determinism, DoesNotDependOnTheNumberOfThreads) {
  SimulationDesc desc;
  desc.threads = 1;
  Simulation one = liquid(2048, 60, desc);
  for (const int threads : {2, 0}) {
    desc.threads = threads;
    Simulation several = liquid(2048, 60, desc);
    EXPECT_TRUE(same_atoms(one.particles(), several.particles()));
    EXPECT_TRUE(same_bits(one.energies().total(), several.energies().total()));
  }
}

// Forces are summed in the order of (cell, id), so that a permutation of the records changes no bit of the trajectory.
TEST(Determinism, DoesNotDependOnTheOrderOfTheRecords) {
  SimulationDesc desc;
  desc.atoms = 2048;
  Simulation untouched(desc);
  Simulation shuffled(desc);
  for (unsigned i = 0; i < 60; ++i) {
    if (i % 7 == 0) shuffle(shuffled, i);
    untouched.step_with_thermostat(1.6, 0.05);
    shuffled.step_with_thermostat(1.6, 0.05);
    ASSERT_TRUE(same_atoms(untouched.particles(), shuffled.particles())) << "step " << i;
    ASSERT_TRUE(same_bits(untouched.energies().pressure, shuffled.energies().pressure));
  }
  EXPECT_NE(shuffled.particles()[0].id, 0);
  EXPECT_GT(shuffled.list_builds(), 3u);
}

}  // namespace
}  // namespace melt
