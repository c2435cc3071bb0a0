#include "kernels/treelet_traverse.h"

#include "kernels/pkd_traverse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "/tmp/probe/ni/tt.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

#include "kernels/treelet_packet-inl.h"
#include "kernels/treelet_stream-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

template <class Positions>
void TreeletFirstHitsIn(const PkdTree& tree, const Treelets& treelets, const TreeMargin& margin, const Ray* rays,
                        Hit* hits, std::size_t count) {
  const Positions positions(tree);
  const std::size_t longest = std::min(count, longest_packet_stream);
  TreeletPacketStream<Positions> stream(tree, positions, treelets, margin, longest);
  for (std::size_t begin = 0; begin < count; begin += longest)
    stream.Run(rays + begin, hits + begin, std::min(longest, count - begin));
}

template <class Positions>
void TreeletAnyHitsIn(const PkdTree& tree, const Treelets& treelets, const TreeMargin& margin, const Ray* rays,
                      std::uint8_t* occluded, std::size_t count) {
  const Positions positions(tree);
  const std::size_t longest = std::min(count, longest_treelet_stream);
  TreeletStream<Positions> stream(tree, positions, treelets, margin, longest);
  for (std::size_t begin = 0; begin < count; begin += longest)
    stream.Run(rays + begin, occluded + begin, std::min(longest, count - begin));
}

void TreeletFirstHits(const PkdTree& tree, const Treelets& treelets, const TreeMargin& margin, const Ray* rays,
                      Hit* hits, std::size_t count) {
  switch (layout_of(tree)) {
    case PkdLayout::placed_f32:
      return TreeletFirstHitsIn<PlacedPositions<float>>(tree, treelets, margin, rays, hits, count);
    case PkdLayout::placed_f64:
      return TreeletFirstHitsIn<PlacedPositions<double>>(tree, treelets, margin, rays, hits, count);
    case PkdLayout::indexed_f32:
      return TreeletFirstHitsIn<IndexedPositions<float>>(tree, treelets, margin, rays, hits, count);
    case PkdLayout::indexed_f64:
      return TreeletFirstHitsIn<IndexedPositions<double>>(tree, treelets, margin, rays, hits, count);
    case PkdLayout::general:
      return TreeletFirstHitsIn<GeneralPositions>(tree, treelets, margin, rays, hits, count);
  }
}

void TreeletAnyHits(const PkdTree& tree, const Treelets& treelets, const TreeMargin& margin, const Ray* rays,
                    std::uint8_t* occluded, std::size_t count) {
  switch (layout_of(tree)) {
    case PkdLayout::placed_f32:
      return TreeletAnyHitsIn<PlacedPositions<float>>(tree, treelets, margin, rays, occluded, count);
    case PkdLayout::placed_f64:
      return TreeletAnyHitsIn<PlacedPositions<double>>(tree, treelets, margin, rays, occluded, count);
    case PkdLayout::indexed_f32:
      return TreeletAnyHitsIn<IndexedPositions<float>>(tree, treelets, margin, rays, occluded, count);
    case PkdLayout::indexed_f64:
      return TreeletAnyHitsIn<IndexedPositions<double>>(tree, treelets, margin, rays, occluded, count);
    case PkdLayout::general:
      return TreeletAnyHitsIn<GeneralPositions>(tree, treelets, margin, rays, occluded, count);
  }
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace insitu::kernels {

HWY_EXPORT(TreeletFirstHits);
HWY_EXPORT(TreeletAnyHits);

// Particles so small, or so far away, that f32 tests of the whole tree would tell too little go the way of the tree
// alone, which has a frame of its own for every leaf.
void treelet_first_hits(const PkdTree& tree, const Treelets& treelets, const Ray* rays, Hit* hits, std::size_t count) {
  const TreeMargin margin(tree);
  if (!treelets.exist() || !margin.fits) return pkd_first_hits(tree, rays, hits, count);
  HWY_DYNAMIC_DISPATCH(TreeletFirstHits)(tree, treelets, margin, rays, hits, count);
}

void treelet_any_hits(const PkdTree& tree, const Treelets& treelets, const Ray* rays, std::uint8_t* occluded,
                      std::size_t count) {
  const TreeMargin margin(tree);
  if (!treelets.exist() || !margin.fits) return pkd_any_hits(tree, rays, occluded, count);
  HWY_DYNAMIC_DISPATCH(TreeletAnyHits)(tree, treelets, margin, rays, occluded, count);
}

}  // namespace insitu::kernels
#endif
