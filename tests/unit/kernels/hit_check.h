// Hits of a tree against the brute force over all its particles: distances and items, bit for bit.
#pragma once

#include <string>
#include <vector>

#include "kernels/pkd_tree.h"
#include "unit/kernels/counter_random.h"
#include "unit/kernels/test_tree.h"

namespace insitu::testing {

// Rays of all kinds, in turn: from outside, grazing, along the axes (with zeros of both signs), from inside, leaving a
// surface, from far away, within planes of equal coordinates.
std::vector<kernels::Ray> make_rays(const TestTree& tree, std::size_t count, CounterRandom& random);

// From the rays that hit something: the same with a limit exactly at the hit, one step before it, and without the item.
std::vector<kernels::Ray> limit_rays(const kernels::PkdTree& tree, const std::vector<kernels::Ray>& rays);

struct HitCounts {
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;
};

// First, any and (for every `all_hits_every`-th ray) all hits, on every SIMD target of the machine. Differences are
// failures of the running test, with the case in the message.
HitCounts expect_brute_force_hits(const kernels::PkdTree& tree, const std::vector<kernels::Ray>& rays,
                                  std::size_t all_hits_every, const std::string& what);

}  // namespace insitu::testing
