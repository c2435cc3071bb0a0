#include "kernels/pkd_traverse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/pkd_traverse.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

#include "kernels/pkd_packet-inl.h"
#include "kernels/pkd_stream-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

template <class Positions>
void FirstHitsIn(const PkdTree& tree, const Ray* rays, Hit* hits, std::size_t count) {
  const Positions positions(tree);
  const TreeMargin margin(tree);
  RayPacket packet;
  for (std::size_t begin = 0; begin < count; begin += packet_size) {
    const std::size_t n = std::min(packet_size, count - begin);
    FirstHitVisitor visitors[packet_size];
    double limits[packet_size];
    for (std::size_t i = 0; i < n; ++i) {
      visitors[i] = FirstHitVisitor(rays[begin + i], hits[begin + i]);
      limits[i] = visitors[i].t_limit();
    }
    bool together = n >= fewest_together;
    for (std::size_t i = 0; i < n; ++i) together = together && margin.Fits(rays[begin + i]);
    if (together) {
      packet.Load(tree, margin, rays + begin, n, limits);
      PacketTraversal(tree, positions, rays + begin, packet, visitors).Run();
    } else {
      for (std::size_t i = 0; i < n; ++i) TraverseTree(tree, positions, rays[begin + i], visitors[i]);
    }
  }
}

template <class Positions>
void AnyHitsIn(const PkdTree& tree, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  const Positions positions(tree);
  const TreeMargin margin(tree);
  if (count >= fewest_together && margin.fits) {
    const std::size_t longest = std::min(count, longest_stream);
    AnyHitStream stream(tree, positions, margin, rays, occluded, longest);
    for (std::size_t begin = 0; begin < count; begin += longest) stream.Run(begin, std::min(longest, count - begin));
    return;
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
