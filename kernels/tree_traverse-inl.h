// First and any hits of many rays, whatever the nodes. Included once per SIMD target.
#if defined(INSITU_KERNELS_TREE_TRAVERSE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_TREE_TRAVERSE_INL_H_
#undef INSITU_KERNELS_TREE_TRAVERSE_INL_H_
#else
#define INSITU_KERNELS_TREE_TRAVERSE_INL_H_
#endif

#include "kernels/ray_packet-inl.h"
#include "kernels/ray_stream-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

template <class Nodes, class Positions>
void FirstHitsOver(const PkdTree& tree, const Positions& positions, const Nodes& nodes, const TreeMargin& margin,
                   const Ray* rays, Hit* hits, std::size_t count) {
  const std::size_t longest = std::min(count, longest_packet_stream);
  FirstHitStream<Nodes, Positions> stream(tree, positions, nodes, margin, longest);
  for (std::size_t begin = 0; begin < count; begin += longest)
    stream.Run(rays + begin, hits + begin, std::min(longest, count - begin));
}

template <class Nodes, class Positions>
void AnyHitsOver(const PkdTree& tree, const Positions& positions, const Nodes& nodes, const TreeMargin& margin,
                 const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  const std::size_t longest = std::min(count, longest_stream);
  AnyHitStream<Nodes, Positions> stream(tree, positions, nodes, margin, longest);
  for (std::size_t begin = 0; begin < count; begin += longest)
    stream.Run(rays + begin, occluded + begin, std::min(longest, count - begin));
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
