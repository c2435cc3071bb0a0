// The library's walks over a tree in order whose split axes go round robin: the kernels as they are, with another rule
// for the axis, so that the two differ in nothing else. Included once per SIMD target.
#if defined(INSITU_BENCH_ROUND_ROBIN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_BENCH_ROUND_ROBIN_INL_H_
#undef INSITU_BENCH_ROUND_ROBIN_INL_H_
#else
#define INSITU_BENCH_ROUND_ROBIN_INL_H_
#endif

#include "kernels/pkd_nodes-inl.h"
#include "kernels/pkd_reference.h"
#include "kernels/tree_traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

struct RoundRobin {
  template <class Key>
  static HWY_INLINE unsigned Axis(const Key*, const Key*, unsigned depth) {
    return depth % 3;
  }
};

// As in kernels/pkd_traverse.cc.
constexpr std::uint64_t round_robin_leaf = 64;

// Few rays, small trees and extreme scales, which only tests bring, are left to brute force.
inline bool IsRoundRobinWalked(const PkdTree& tree, const TreeMargin& margin, const Ray* rays, std::size_t count) {
  bool walked = count >= 4 && margin.fits && tree.count > pkd_leaf_size;
  for (std::size_t i = 0; i < count; ++i) walked = walked && margin.Fits(rays[i]);
  return walked;
}

inline void RoundRobinFirstHits(const PkdTree& tree, const Ray* rays, Hit* hits, std::size_t count) {
  const PlacedPositions<float> positions(tree);
  const TreeMargin margin(tree);
  if (!IsRoundRobinWalked(tree, margin, rays, count)) {
    for (std::size_t i = 0; i < count; ++i) hits[i] = reference_first_hit(tree, rays[i]);
    return;
  }
  const PkdNodes<PlacedPositions<float>, RoundRobin> nodes(tree, positions, margin, round_robin_leaf, false);
  FirstHitsOver(tree, positions, nodes, margin, rays, hits, count);
}

inline void RoundRobinAnyHits(const PkdTree& tree, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  const PlacedPositions<float> positions(tree);
  const TreeMargin margin(tree);
  if (!IsRoundRobinWalked(tree, margin, rays, count)) {
    for (std::size_t i = 0; i < count; ++i) occluded[i] = reference_any_hit(tree, rays[i]) ? 1 : 0;
    return;
  }
  const PkdNodes<PlacedPositions<float>, RoundRobin> nodes(tree, positions, margin, round_robin_leaf, true);
  AnyHitsOver(tree, positions, nodes, margin, rays, occluded, count);
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
