#include "kernels/pkd_traverse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/pkd_traverse.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

#include "kernels/pkd_nodes-inl.h"
#include "kernels/tree_traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// Fewer rays than this go one by one.
constexpr std::size_t fewest_together = 4;

// The walk goes down to the leaves that the build has left, and no farther: their particles are in any order.
constexpr std::uint64_t longest_leaf = pkd_leaf_size;

bool IsWalked(const PkdTree& tree, const TreeMargin& margin, std::size_t rays) {
  return rays >= fewest_together && margin.fits && tree.count > pkd_leaf_size;
}

template <class Positions>
void FirstHitsIn(const PkdTree& tree, const Ray* rays, Hit* hits, std::size_t count) {
  const Positions positions(tree);
  const TreeMargin margin(tree);
  if (IsWalked(tree, margin, count)) {
    // When the first of equal spheres is excluded, which of the others is shown depends on all of them.
    bool one_for_all = true;
    for (std::size_t i = 0; i < count; ++i) one_for_all = one_for_all && rays[i].exclude == no_item;
    const PkdNodes<Positions> nodes(tree, positions, margin, longest_leaf, one_for_all);
    return FirstHitsOver(tree, positions, nodes, margin, rays, hits, count);
  }
  for (std::size_t i = 0; i < count; ++i) {
    FirstHitVisitor visitor(rays[i], hits[i], is_own_hit(tree, hits[i]));
    TraverseTree(tree, positions, rays[i], visitor);
  }
}

template <class Positions>
void AnyHitsIn(const PkdTree& tree, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  const Positions positions(tree);
  const TreeMargin margin(tree);
  if (IsWalked(tree, margin, count)) {
    const PkdNodes<Positions> nodes(tree, positions, margin, longest_leaf, true);
    return AnyHitsOver(tree, positions, nodes, margin, rays, occluded, count);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (occluded[i] != 0) continue;
    AnyHitVisitor visitor(rays[i]);
    TraverseTree(tree, positions, rays[i], visitor);
    occluded[i] = visitor.found ? 1 : 0;
  }
}

void FirstHits(const PkdTree& tree, const Ray* rays, Hit* hits, std::size_t count) {
  switch (layout_of(tree)) {
    case PkdLayout::placed_f32:
      return FirstHitsIn<PlacedPositions<float>>(tree, rays, hits, count);
    case PkdLayout::placed_f64:
      return FirstHitsIn<PlacedPositions<double>>(tree, rays, hits, count);
    case PkdLayout::indexed_f32:
      return FirstHitsIn<IndexedPositions<float>>(tree, rays, hits, count);
    case PkdLayout::indexed_f64:
      return FirstHitsIn<IndexedPositions<double>>(tree, rays, hits, count);
    case PkdLayout::general:
      return FirstHitsIn<GeneralPositions>(tree, rays, hits, count);
  }
}

void AnyHits(const PkdTree& tree, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  switch (layout_of(tree)) {
    case PkdLayout::placed_f32:
      return AnyHitsIn<PlacedPositions<float>>(tree, rays, occluded, count);
    case PkdLayout::placed_f64:
      return AnyHitsIn<PlacedPositions<double>>(tree, rays, occluded, count);
    case PkdLayout::indexed_f32:
      return AnyHitsIn<IndexedPositions<float>>(tree, rays, occluded, count);
    case PkdLayout::indexed_f64:
      return AnyHitsIn<IndexedPositions<double>>(tree, rays, occluded, count);
    case PkdLayout::general:
      return AnyHitsIn<GeneralPositions>(tree, rays, occluded, count);
  }
}

void AllHits(const PkdTree& tree, const Ray& ray, std::vector<Span>& spans) {
  AllHitsVisitor visitor(ray, spans);
  switch (layout_of(tree)) {
    case PkdLayout::placed_f32:
      return TraverseTree(tree, PlacedPositions<float>(tree), ray, visitor);
    case PkdLayout::placed_f64:
      return TraverseTree(tree, PlacedPositions<double>(tree), ray, visitor);
    case PkdLayout::indexed_f32:
      return TraverseTree(tree, IndexedPositions<float>(tree), ray, visitor);
    case PkdLayout::indexed_f64:
      return TraverseTree(tree, IndexedPositions<double>(tree), ray, visitor);
    case PkdLayout::general:
      return TraverseTree(tree, GeneralPositions(tree), ray, visitor);
  }
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace insitu::kernels {

HWY_EXPORT(FirstHits);
HWY_EXPORT(AnyHits);
HWY_EXPORT(AllHits);

void pkd_first_hits(const PkdTree& tree, const Ray* rays, Hit* hits, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(FirstHits)(tree, rays, hits, count);
}

void pkd_any_hits(const PkdTree& tree, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(AnyHits)(tree, rays, occluded, count);
}

void pkd_all_hits(const PkdTree& tree, const Ray& ray, std::vector<Span>& spans) {
  HWY_DYNAMIC_DISPATCH(AllHits)(tree, ray, spans);
}

}  // namespace insitu::kernels
#endif
