// The library's packets and streams over a tree in order whose split axes go round robin: the kernels as they are, with
// another box, which counts levels instead of comparing its sides. It is clipped all the same, as in the library, so
// that the two differ in nothing but the choice of the axis. Included once per SIMD target.
#if defined(INSITU_BENCH_ROUND_ROBIN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_BENCH_ROUND_ROBIN_INL_H_
#undef INSITU_BENCH_ROUND_ROBIN_INL_H_
#else
#define INSITU_BENCH_ROUND_ROBIN_INL_H_
#endif

#include "kernels/pkd_packet-inl.h"
#include "kernels/pkd_stream-inl.h"

#ifndef INSITU_BENCH_ROUND_ROBIN_ONCE_
#define INSITU_BENCH_ROUND_ROBIN_ONCE_
namespace insitu::kernels {

// A float that the kernels keep in boxes of their own kind.
struct RoundRobinKey {
  float value;
  explicit RoundRobinKey(double from) : value(static_cast<float>(from)) {}
  operator float() const { return value; }
};

template <>
struct PkdBox<RoundRobinKey> {
  float lower[3];
  float upper[3];
  int next_axis;

  // Kernels ask once per split, before they derive the boxes of the children.
  int split_axis() {
    const int axis = next_axis;
    next_axis = axis == 2 ? 0 : axis + 1;
    return axis;
  }
  bool is_point() const { return lower[0] == upper[0] && lower[1] == upper[1] && lower[2] == upper[2]; }
};

class RoundRobinPositions : public PlacedPositions<float> {
 public:
  using Key = RoundRobinKey;
  using PlacedPositions<float>::PlacedPositions;
  Key key(std::uint64_t place, int axis) const {
    return Key(static_cast<double>(PlacedPositions<float>::key(place, axis)));
  }
};

}  // namespace insitu::kernels
#endif

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

template <>
HWY_INLINE PkdBox<RoundRobinKey> RootBox<RoundRobinKey>(const PkdTree& tree) {
  PkdBox<RoundRobinKey> box;
  box.next_axis = 0;
  for (int c = 0; c < 3; ++c) {
    box.lower[c] = static_cast<float>(tree.lower[c]);
    box.upper[c] = static_cast<float>(tree.upper[c]);
  }
  return box;
}

// Leaves are read as those of any other packed f32 records.
template <>
class LeafCentres<RoundRobinPositions> : public LeafCentres<PlacedPositions<float>> {
 public:
  HWY_INLINE LeafCentres(const RoundRobinPositions& positions, std::uint64_t begin, std::size_t count)
      : LeafCentres<PlacedPositions<float>>(positions, begin, count) {}
};

template <bool exact_head, class Visitor>
HWY_INLINE bool VisitLeaf(const PkdTree& tree, const RoundRobinPositions& positions, std::uint64_t begin,
                          std::uint64_t end, const RayFrame& frame, const Ray& ray, Visitor& visitor) {
  return VisitLeaf<exact_head, PlacedPositions<float>>(tree, positions, begin, end, frame, ray, visitor);
}

// The drivers of kernels/pkd_traverse.cc.
inline void RoundRobinFirstHits(const PkdTree& tree, const Ray* rays, Hit* hits, std::size_t count) {
  const RoundRobinPositions positions(tree);
  const TreeMargin margin(tree);
  RayPacket packet;
  for (std::size_t begin = 0; begin < count; begin += packet_size) {
    const std::size_t n = std::min(packet_size, count - begin);
    FirstHitVisitor visitors[packet_size];
    double limits[packet_size];
    bool together = n >= fewest_together;
    for (std::size_t i = 0; i < n; ++i) {
      visitors[i] = FirstHitVisitor(rays[begin + i], hits[begin + i]);
      limits[i] = visitors[i].t_limit();
      together = together && margin.Fits(rays[begin + i]);
    }
    if (together) {
      packet.Load(tree, margin, rays + begin, n, limits);
      PacketTraversal(tree, positions, rays + begin, packet, visitors).Run();
    } else {
      for (std::size_t i = 0; i < n; ++i) TraverseTree(tree, positions, rays[begin + i], visitors[i]);
    }
  }
}

inline void RoundRobinAnyHits(const PkdTree& tree, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  const RoundRobinPositions positions(tree);
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

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
