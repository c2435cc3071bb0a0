// One start, one run, to the last bit: whatever the number of threads and the order of the particles.
#include <gtest/gtest.h>

#include "states.h"

namespace cosmo {
namespace {

SimulationDesc small(int threads) {
  SimulationDesc desc;
  desc.particles = 20;  // 8000 particles: more than one block of work
  desc.side = 20.0;
  desc.steps = 16;
  desc.threads = threads;
  return desc;
}

TEST(Determinism, DoesNotDependOnTheNumberOfThreads) {
  Simulation one(small(1));
  while (!one.done()) one.step();
  for (const int threads : {2, 0}) {
    Simulation several(small(threads));
    while (!several.done()) several.step();
    EXPECT_TRUE(same_particles(one.particles(), several.particles()));
    EXPECT_EQ(one.density_contrast(), several.density_contrast());
  }
  EXPECT_GT(one.density_contrast(), 1.0);
}

// Nor on colours being looked at.
TEST(Determinism, DoesNotDependOnTheOrderOfTheParticles) {
  Simulation untouched(small(2));
  Simulation shuffled(small(2));
  while (!untouched.done()) {
    if (untouched.steps() % 3 == 0) shuffle(shuffled.particles(), static_cast<unsigned>(untouched.steps()));
    if (untouched.steps() % 2 == 0) shuffled.color_by_density();
    if (untouched.steps() % 2 == 1) shuffled.color_by_speed();
    untouched.step();
    shuffled.step();
    ASSERT_TRUE(same_particles(untouched.particles(), shuffled.particles())) << "step " << untouched.steps();
  }
  untouched.color_by_speed();
  shuffled.color_by_speed();
  EXPECT_TRUE(same_bytes(by_id(untouched.particles()).color, by_id(shuffled.particles()).color));
  untouched.color_by_density();
  shuffled.color_by_density();
  EXPECT_TRUE(same_bytes(by_id(untouched.particles()).color, by_id(shuffled.particles()).color));
  EXPECT_NE(shuffled.particles().id[0], 0);
}

}  // namespace
}  // namespace cosmo
