#include "paper_traverse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "paper_traverse.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

#include "paper_walk-inl.h"
#include "round_robin-inl.h"

HWY_BEFORE_NAMESPACE();
namespace bench::HWY_NAMESPACE {

using insitu::kernels::AnyHitVisitor;
using insitu::kernels::FirstHitVisitor;
using insitu::kernels::Hit;

// A ray that the frame of the tree does not fit: the whole walk in double (as TraverseTree in
// kernels/pkd_single-inl.h).
template <class Nodes, class Visitor>
HWY_NOINLINE void WalkInDouble(const PkdTree& tree, const Positions& positions, const Nodes& nodes, const Ray& exact,
                               Visitor& visitor) {
  constexpr double parallel = 1e-200;
  PaperRay<double> ray{};
  ray.t_low = exact.t_min;
  ray.t_high = visitor.t_limit();
  double t_enter = ray.t_low;
  double t_leave = ray.t_high;
  for (int c = 0; c < 3; ++c) {
    const double direction = exact.direction[c];
    ray.origin[c] = exact.origin[c];
    ray.inverse[c] = std::abs(direction) > parallel ? 1.0 / direction : (direction < 0.0 ? -1.0 : 1.0) / parallel;
    const double extent = std::abs(tree.lower[c]) + std::abs(tree.upper[c]) + std::abs(exact.origin[c]);
    ray.widening[c] = (tree.radius_max * (1.0 + 1e-12) + extent * 4e-15) * std::abs(ray.inverse[c]);
    const double at_lower = (tree.lower[c] - ray.origin[c]) * ray.inverse[c];
    const double at_upper = (tree.upper[c] - ray.origin[c]) * ray.inverse[c];
    t_enter = std::max(t_enter, std::min(at_lower, at_upper) - ray.widening[c]);
    t_leave = std::min(t_leave, std::max(at_lower, at_upper) + ray.widening[c]);
  }
  if (t_enter <= t_leave)
    SingleWalk<Nodes, double, Visitor>(tree, positions, nodes, 0.0, exact, ray, visitor).Run(t_enter, t_leave);
}

// Up to 16 rays, and 16 limits: minus infinity for those without a ray. visitors[i] of those with limits[i] below their
// t_min are not asked.
template <class Nodes, class Visitor>
HWY_INLINE void TraceSome(const PaperView& view, const Positions& positions, const Nodes& nodes,
                          const TreeMargin& margin, const Ray* rays, Visitor* visitors, double* limits,
                          std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (HWY_LIKELY(margin.Fits(rays[i])) || limits[i] < rays[i].t_min) continue;
    WalkInDouble(view.tree, positions, nodes, rays[i], visitors[i]);
    limits[i] = -std::numeric_limits<double>::infinity();
  }
  in::RayColumns columns;
  columns.Load(rays, count);
  if (view.way == RayWay::packet) {
    in::PaperPacket packet;
    packet.Load(view.tree, margin, columns, limits);
    PacketWalk<Nodes, Visitor>(view.tree, positions, nodes, rays, packet, visitors).Run();
    return;
  }
  in::EnteredRays entered;
  in::EnterTree(view.tree, margin, columns, limits, false, entered);
  for (std::size_t i = 0; i < count; ++i) {
    if (!entered.is_inside(i)) continue;
    PaperRay<float> ray;
    for (int c = 0; c < 3; ++c) {
      ray.origin[c] = entered.origin[c][i];
      ray.direction[c] = entered.direction[c][i];
      ray.inverse[c] = entered.inverse[c][i];
      ray.widening[c] = in::WideningOf(view.tree, margin) * std::abs(ray.inverse[c]);
    }
    ray.t_low = entered.t_low[i];
    ray.t_high = entered.t_high[i];
    ray.t_shift = entered.t_shift[i];
    SingleWalk<Nodes, float, Visitor>(view.tree, positions, nodes, margin.value, rays[i], ray, visitors[i])
        .Run(0.0f, ray.t_high);
  }
}

// None yet.
struct PacketLimits {
  HWY_ALIGN double t[in::packet_size];
  PacketLimits() { std::fill(std::begin(t), std::end(t), -std::numeric_limits<double>::infinity()); }
};

template <class Nodes>
void FirstHitsIn(const PaperView& view, const Ray* rays, Hit* hits, std::size_t count) {
  const Positions positions(view.tree);
  const Nodes nodes(view.tree, view.axes);
  const TreeMargin margin(view.tree);
  for (std::size_t begin = 0; begin < count; begin += in::packet_size) {
    const std::size_t n = std::min(in::packet_size, count - begin);
    FirstHitVisitor visitors[in::packet_size];
    PacketLimits limits;
    for (std::size_t i = 0; i < n; ++i) {
      visitors[i] = FirstHitVisitor(rays[begin + i], hits[begin + i], false);
      limits.t[i] = visitors[i].t_limit();
    }
    TraceSome(view, positions, nodes, margin, rays + begin, visitors, limits.t, n);
  }
}

template <class Nodes>
void AnyHitsIn(const PaperView& view, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  const Positions positions(view.tree);
  const Nodes nodes(view.tree, view.axes);
  const TreeMargin margin(view.tree);
  for (std::size_t begin = 0; begin < count; begin += in::packet_size) {
    const std::size_t n = std::min(in::packet_size, count - begin);
    AnyHitVisitor visitors[in::packet_size];
    PacketLimits limits;
    for (std::size_t i = 0; i < n; ++i) {
      visitors[i] = AnyHitVisitor(rays[begin + i]);
      limits.t[i] = occluded[begin + i] == 0 ? rays[begin + i].t_max : -std::numeric_limits<double>::infinity();
    }
    TraceSome(view, positions, nodes, margin, rays + begin, visitors, limits.t, n);
    for (std::size_t i = 0; i < n; ++i)
      if (visitors[i].found) occluded[begin + i] = 1;
  }
}

// Calls body with the class of nodes that the view asks for.
template <class Body>
void ForNodes(const PaperView& view, const Body& body) {
  const bool heap = view.layout == TreeLayout::heap;
  if (view.rule == AxisRule::round_robin) {
    if (heap) return body(static_cast<PaperNodes<HeapOrder, AxisRule::round_robin>*>(nullptr));
    return body(static_cast<PaperNodes<InOrder, AxisRule::round_robin>*>(nullptr));
  }
  if (heap) return body(static_cast<PaperNodes<HeapOrder, AxisRule::longest_side>*>(nullptr));
  return body(static_cast<PaperNodes<InOrder, AxisRule::longest_side>*>(nullptr));
}

void FirstHits(const PaperView& view, const Ray* rays, Hit* hits, std::size_t count) {
  ForNodes(view, [&](auto* nodes) { FirstHitsIn<std::remove_pointer_t<decltype(nodes)>>(view, rays, hits, count); });
}

void AnyHits(const PaperView& view, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  ForNodes(view, [&](auto* nodes) { AnyHitsIn<std::remove_pointer_t<decltype(nodes)>>(view, rays, occluded, count); });
}

void RoundRobinFirstHits(const PkdTree& tree, const Ray* rays, Hit* hits, std::size_t count) {
  in::RoundRobinFirstHits(tree, rays, hits, count);
}

void RoundRobinAnyHits(const PkdTree& tree, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  in::RoundRobinAnyHits(tree, rays, occluded, count);
}

}  // namespace bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bench {

HWY_EXPORT(FirstHits);
HWY_EXPORT(AnyHits);
HWY_EXPORT(RoundRobinFirstHits);
HWY_EXPORT(RoundRobinAnyHits);

void paper_first_hits(const PaperView& view, const insitu::kernels::Ray* rays, insitu::kernels::Hit* hits,
                      std::size_t count) {
  if (view.tree.count != 0) HWY_DYNAMIC_DISPATCH(FirstHits)(view, rays, hits, count);
}

void paper_any_hits(const PaperView& view, const insitu::kernels::Ray* rays, std::uint8_t* occluded,
                    std::size_t count) {
  if (view.tree.count != 0) HWY_DYNAMIC_DISPATCH(AnyHits)(view, rays, occluded, count);
}

void round_robin_first_hits(const insitu::kernels::PkdTree& tree, const insitu::kernels::Ray* rays,
                            insitu::kernels::Hit* hits, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(RoundRobinFirstHits)(tree, rays, hits, count);
}

void round_robin_any_hits(const insitu::kernels::PkdTree& tree, const insitu::kernels::Ray* rays,
                          std::uint8_t* occluded, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(RoundRobinAnyHits)(tree, rays, occluded, count);
}

}  // namespace bench
#endif
