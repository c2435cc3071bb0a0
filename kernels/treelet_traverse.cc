#include "kernels/treelet_traverse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/treelet_traverse.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

#include "kernels/treelet_packet-inl.h"
#include "kernels/treelet_stream-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

template <class Positions>
void TreeletFirstHitsIn(const PkdTree& tree, const Treelets& treelets, const Ray* rays, Hit* hits, std::size_t count) {
  const Positions positions(tree);
  const TreeMargin margin(tree);
  const std::size_t longest = std::min(count, longest_packet_stream);
  TreeletPacketStream<Positions> stream(tree, positions, treelets, margin, longest);
  FirstHitVisitor visitors[longest_packet_stream];
  for (std::size_t begin = 0; begin < count; begin += longest) {
    const std::size_t n = std::min(longest, count - begin);
    for (std::size_t i = 0; i < n; ++i) visitors[i] = FirstHitVisitor(rays[begin + i], hits[begin + i]);
    stream.Run(rays + begin, visitors, n);
  }
}

template <class Positions>
void TreeletAnyHitsIn(const PkdTree& tree, const Treelets& treelets, const Ray* rays, std::uint8_t* occluded,
                      std::size_t count) {
  const Positions positions(tree);
  const TreeMargin margin(tree);
  const std::size_t longest = std::min(count, longest_treelet_stream);
  TreeletStream<Positions, AnyHitVisitor> stream(tree, positions, treelets, margin, longest);
  std::vector<AnyHitVisitor> visitors(longest);
  for (std::size_t begin = 0; begin < count; begin += longest) {
    const std::size_t n = std::min(longest, count - begin);
    for (std::size_t i = 0; i < n; ++i) visitors[i] = AnyHitVisitor(rays[begin + i]);
    stream.Run(rays + begin, visitors.data(), n);
    for (std::size_t i = 0; i < n; ++i) occluded[begin + i] |= visitors[i].found ? 1 : 0;
  }
}

void TreeletFirstHits(const PkdTree& tree, const Treelets& treelets, const Ray* rays, Hit* hits, std::size_t count) {
  return TreeletFirstHitsIn<PlacedPositions<float>>(tree, treelets, rays, hits, count);
}

void TreeletAnyHits(const PkdTree& tree, const Treelets& treelets, const Ray* rays, std::uint8_t* occluded,
                    std::size_t count) {
  return TreeletAnyHitsIn<PlacedPositions<float>>(tree, treelets, rays, occluded, count);
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace insitu::kernels {

HWY_EXPORT(TreeletFirstHits);
HWY_EXPORT(TreeletAnyHits);

void treelet_first_hits(const PkdTree& tree, const Treelets& treelets, const Ray* rays, Hit* hits, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(TreeletFirstHits)(tree, treelets, rays, hits, count);
}

void treelet_any_hits(const PkdTree& tree, const Treelets& treelets, const Ray* rays, std::uint8_t* occluded,
                      std::size_t count) {
  HWY_DYNAMIC_DISPATCH(TreeletAnyHits)(tree, treelets, rays, occluded, count);
}

}  // namespace insitu::kernels
#endif
