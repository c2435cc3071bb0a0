// Packets of coherent rays through treelets: SIMD over the children of a node for the beam around the rays, then over
// the rays for the children that the beam meets; in treelets likewise for particles. Included once per SIMD target.
#if defined(INSITU_KERNELS_TREELET_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_TREELET_PACKET_INL_H_
#undef INSITU_KERNELS_TREELET_PACKET_INL_H_
#else
#define INSITU_KERNELS_TREELET_PACKET_INL_H_
#endif

#include "kernels/pkd_enter-inl.h"
#include "kernels/treelet_leaf-inl.h"
#include "kernels/treelet_node-inl.h"
#include "kernels/treelet_order.h"
#include "kernels/treelets.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// Rays of one octant that start close to each other, and the beam around them, two ways:
//   - as an interval of rays: a box that no ray of the interval meets is met by none of the packet (Reshetov, Soupikov,
//     Hurley, "Multi-level ray tracing algorithm", SIGGRAPH 2005). For t >= 0 near planes are met no earlier than by
//     the origin nearest to them with the smallest slowness, far planes left no later than by the opposite.
//   - as a cone: at distance t all rays stay within start + growth t of the axis.
struct RayBeam {
  float near_start[3];
  float near_inverse[3];
  float far_start[3];
  float far_inverse[3];
  float origin[3];
  float direction[3];
  float start;
  float growth;
};

class TreeletPacket {
 public:
  static constexpr std::size_t size = EnteredRays::size;

  EnteredRays lanes;
  HWY_ALIGN float start[3][size];  // - origin / direction
  HWY_ALIGN float r_place[size];
  RayBeam beam;

  // False: the rays of `active` go too different ways for a beam.
  bool MakeBeam(std::uint32_t active, double margin) {
    const D d;
    const std::size_t n = hn::Lanes(d);
    const V big = hn::Set(d, 3e38f);
    const float rays = static_cast<float>(hwy::PopCount(active));
    float squared_length = 0.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      V origins = hn::Zero(d);
      V directions = hn::Zero(d);
      V o_low = big, o_high = hn::Neg(big), v_low = big, v_high = hn::Neg(big);
      for (std::size_t i = 0; i < size; i += n) {
        const auto is_active = LanesOf(active, i);
        const V o = hn::Load(d, lanes.origin[c] + i);
        const V v = hn::Load(d, lanes.inverse[c] + i);
        hn::Store(hn::Neg(hn::Mul(o, v)), d, start[c] + i);
        origins = hn::Add(origins, hn::IfThenElseZero(is_active, o));
        directions = hn::Add(directions, hn::IfThenElseZero(is_active, hn::Load(d, lanes.direction[c] + i)));
        o_low = hn::Min(o_low, hn::IfThenElse(is_active, o, big));
        o_high = hn::Max(o_high, hn::IfThenElse(is_active, o, hn::Neg(big)));
        v_low = hn::Min(v_low, hn::IfThenElse(is_active, v, big));
        v_high = hn::Max(v_high, hn::IfThenElse(is_active, v, hn::Neg(big)));
      }
      const float low = hn::GetLane(hn::MinOfLanes(d, o_low));
      const float high = hn::GetLane(hn::MaxOfLanes(d, o_high));
      const float slowest = hn::GetLane(hn::MinOfLanes(d, v_low));
      const float fastest = hn::GetLane(hn::MaxOfLanes(d, v_high));
      const bool is_up = slowest >= 0.0f;
      beam.near_inverse[c] = is_up ? slowest : fastest;
      beam.far_inverse[c] = is_up ? fastest : slowest;
      beam.near_start[c] = -(is_up ? high : low) * beam.near_inverse[c];
      beam.far_start[c] = -(is_up ? low : high) * beam.far_inverse[c];
      beam.origin[c] = hn::GetLane(hn::SumOfLanes(d, origins)) / rays;
      beam.direction[c] = hn::GetLane(hn::SumOfLanes(d, directions));
      squared_length += beam.direction[c] * beam.direction[c];
    }
    const float length = std::sqrt(squared_length);
    if (!(length > 0.9f * rays)) return false;
    for (float& component : beam.direction) component /= length;
    // Whatever the axis is, the bounds are measured from it. The factors cover the rounding of the measurement.
    V offsets = hn::Zero(d);
    V slopes = hn::Zero(d);
    for (std::size_t i = 0; i < size; i += n) {
      V offset = hn::Zero(d);
      V slope = hn::Zero(d);
      for (std::size_t c = 0; c < 3; ++c) {
        const V apart = hn::Sub(hn::Load(d, lanes.origin[c] + i), hn::Set(d, beam.origin[c]));
        const V turned = hn::Sub(hn::Load(d, lanes.direction[c] + i), hn::Set(d, beam.direction[c]));
        offset = hn::MulAdd(apart, apart, offset);
        slope = hn::MulAdd(turned, turned, slope);
      }
      offsets = hn::Max(offsets, hn::IfThenElseZero(LanesOf(active, i), offset));
      slopes = hn::Max(slopes, hn::IfThenElseZero(LanesOf(active, i), slope));
    }
    beam.start = std::sqrt(hn::GetLane(hn::MaxOfLanes(d, offsets))) * (1.0f + 1e-5f) + static_cast<float>(margin);
    beam.growth = std::sqrt(hn::GetLane(hn::MaxOfLanes(d, slopes))) * (1.0f + 1e-5f);
    return true;
  }

 private:
  using D = hn::CappedTag<float, size>;
  using V = hn::Vec<D>;

  static hn::Mask<D> LanesOf(std::uint32_t active, std::size_t first) {
    const D d;
    const hn::RebindToUnsigned<D> u;
    const auto bits = hn::Shl(hn::Set(u, 1u), hn::Iota(u, static_cast<std::uint32_t>(first)));
    return hn::RebindMask(d, hn::TestBit(hn::Set(u, active), bits));
  }
};

// First hits of up to 16 rays. A spheres-against-lanes test in double with the operations of sphere.h, in their order,
// decides: the same bits as sphere_first_hit.
template <class Positions>
class TreeletPacketTraversal {
 public:
  static constexpr std::size_t size = EnteredRays::size;

  TreeletPacketTraversal(const PkdTree& tree, const Positions& positions, const Treelets& treelets,
                         const TreeMargin& margin)
      : tree_(tree), positions_(positions), treelets_(treelets), margin_(margin), leaf_(tree, margin.value) {
    uniform_ = tree.radius.kind == RadiusView::Kind::uniform;
  }

  // rays[0 .. count), all of which fit the margin.
  void Run(const Ray* rays, FirstHitVisitor* visitors, std::size_t count) {
    rays_ = rays;
    visitors_ = visitors;
    double t_limits[size];
    for (std::size_t i = 0; i < count; ++i) t_limits[i] = visitors[i].t_limit();
    EnterTree(tree_, margin_, rays, t_limits, count, true, packet_.lanes);
    std::uint8_t octants[size];
    for (std::size_t i = 0; i < size; ++i) {
      std::uint8_t octant = 0;
      for (int c = 0; c < 3; ++c)
        if (packet_.lanes.inverse[c][i] < 0.0f) octant = static_cast<std::uint8_t>(octant | 1 << c);
      octants[i] = octant;
    }
    for (std::uint32_t left = packet_.lanes.inside; left != 0;) {
      const std::uint8_t octant = octants[hwy::Num0BitsBelowLS1Bit_Nonzero32(left)];
      std::uint32_t active = 0;
      for (std::size_t i = 0; i < size; ++i) active |= octants[i] == octant ? left & 1u << i : 0;
      left &= ~active;
      packet_.MakeBeam(active, margin_.value);
      RunOctant(octant, active);
    }
  }

 private:
  using D = hn::CappedTag<float, size>;
  using V = hn::Vec<D>;

  struct Entry {
    TreeletRun run;
    std::uint64_t node;
    float t_enter;  // of the beam
    std::uint32_t active;
    unsigned level;
  };

  HWY_INLINE void RunOctant(std::uint32_t octant, std::uint32_t active) {
    const D d;
    Entry stack[8 * Treelets::most_levels];
    std::size_t height = 0;
    Entry now{treelets_.root(), 0, 0.0f, active, 0};
    FindLatest(active);
    for (;;) {
      if (now.level == treelets_.levels) {
        VisitTreelet(now.run, now.active);
      } else {
        const TreeletNode& node = treelets_.nodes[treelets_.level_begin[now.level] + now.node];
        NearFarPlanes planes;
        planes.Decode(node, octant);
        HWY_ALIGN float t_enter[treelet_fanout];
        std::uint32_t met = MeetBeam(planes, t_enter);
        const std::uint32_t flip = treelet_flip(node, octant, treelets_.bits_at(now.level));
        const unsigned bits = treelets_.bits_at(now.level);
        // The farthest first, so that the nearest comes off the stack first.
        while (met != 0) {
          const unsigned k = farthest_child(met, flip);
          met &= ~(1u << k);
          const std::uint32_t child_active = MeetLanes(planes, k) & now.active;
          if (child_active == 0) continue;
          stack[height++] = {child_run(now.run, bits, k), (now.node << bits) + k, t_enter[k], child_active,
                             now.level + 1};
        }
      }
      for (;;) {
        if (height == 0) return;
        now = stack[--height];
        if (now.t_enter <= latest_) break;
      }
      (void)d;
    }
  }

  // The children that the beam meets, and where.
  HWY_INLINE std::uint32_t MeetBeam(const NearFarPlanes& planes, float* t_enter) const {
    const hn::CappedTag<float, treelet_fanout> d;
    using W = hn::Vec<decltype(d)>;
    const RayBeam& beam = packet_.beam;
    std::uint32_t met = 0;
    for (std::size_t k = 0; k < treelet_fanout; k += hn::Lanes(d)) {
      W enter = hn::Zero(d);
      W leave = hn::Set(d, latest_);
      for (std::size_t c = 0; c < 3; ++c) {
        enter = hn::Max(enter, hn::MulAdd(hn::Load(d, planes.near[c] + k), hn::Set(d, beam.near_inverse[c]),
                                          hn::Set(d, beam.near_start[c])));
        leave = hn::Min(leave, hn::MulAdd(hn::Load(d, planes.far[c] + k), hn::Set(d, beam.far_inverse[c]),
                                          hn::Set(d, beam.far_start[c])));
      }
      hn::Store(enter, d, t_enter + k);
      met |= MaskBits(d, hn::Le(enter, leave)) << k;
    }
    return met;
  }

  // The rays that meet child k.
  HWY_INLINE std::uint32_t MeetLanes(const NearFarPlanes& planes, unsigned k) const {
    const D d;
    std::uint32_t met = 0;
    for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
      V enter = hn::Zero(d);
      V leave = hn::Load(d, packet_.lanes.t_high + i);
      for (std::size_t c = 0; c < 3; ++c) {
        const V inverse = hn::Load(d, packet_.lanes.inverse[c] + i);
        const V start = hn::Load(d, packet_.start[c] + i);
        enter = hn::Max(enter, hn::MulAdd(hn::Set(d, planes.near[c][k]), inverse, start));
        leave = hn::Min(leave, hn::MulAdd(hn::Set(d, planes.far[c][k]), inverse, start));
      }
      met |= MaskBits(d, hn::Le(enter, leave)) << i;
    }
    return met;
  }

  // The farthest distance that any ray still looks at.
  HWY_INLINE void FindLatest(std::uint32_t active) {
    float latest = -1.0f;
    for (; active != 0; active &= active - 1)
      latest = std::max(latest, packet_.lanes.t_high[hwy::Num0BitsBelowLS1Bit_Nonzero32(active)]);
    latest_ = latest;
    octant_active_ = active;
  }
  HWY_INLINE void UpdateLatest() {
    const D d;
    V latest = hn::Set(d, -1.0f);
    for (std::size_t i = 0; i < size; i += hn::Lanes(d)) latest = hn::Max(latest, hn::Load(d, packet_.lanes.t_high + i));
    latest_ = hn::GetLane(hn::MaxOfLanes(d, latest));
  }

  HWY_INLINE void VisitTreelet(const TreeletRun& run, std::uint32_t active) {
    const std::uint64_t end = std::min(run.begin + run.span, tree_.count);
    bool changed = false;
    leaf_.VisitWithinBeam(positions_, run.begin, end, packet_.beam, latest_, [&](std::uint64_t place, float radius2) HWY_ATTR {
      changed |= VisitParticle(place, radius2, active);
    });
    if (changed) UpdateLatest();
  }

  HWY_INLINE bool VisitParticle(std::uint64_t place, float radius2, std::uint32_t active) {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    float centre[3];
    positions_.centre_f32(place, centre);
    const V r2 = hn::Set(d, radius2);
    const V cx = hn::Set(d, centre[0]);
    const V cy = hn::Set(d, centre[1]);
    const V cz = hn::Set(d, centre[2]);
    std::uint32_t candidates = 0;
    for (std::size_t i = 0; i < size; i += lanes) {
      const auto [b, distance2] = ApproachOf(
          hn::Sub(cx, hn::Load(d, packet_.lanes.origin[0] + i)), hn::Sub(cy, hn::Load(d, packet_.lanes.origin[1] + i)),
          hn::Sub(cz, hn::Load(d, packet_.lanes.origin[2] + i)), hn::Load(d, packet_.lanes.direction[0] + i),
          hn::Load(d, packet_.lanes.direction[1] + i), hn::Load(d, packet_.lanes.direction[2] + i));
      const auto close = hn::Le(distance2, r2);
      if (hn::AllFalse(d, close)) continue;
      const V s = hn::Sqrt(hn::Max(hn::Sub(r2, distance2), hn::Zero(d)));
      const auto in_time = hn::And(hn::Le(hn::Sub(b, s), hn::Load(d, packet_.lanes.t_high + i)),
                                   hn::Ge(hn::Add(b, s), hn::Load(d, packet_.lanes.t_low + i)));
      candidates |= MaskBits(d, hn::And(close, in_time)) << i;
    }
    candidates &= active;
    if (candidates == 0) return false;
    for (; candidates != 0; candidates &= candidates - 1) {
      const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(candidates);
      visitors_[lane].visit(tree_, positions_, place, rays_[lane]);
      packet_.lanes.t_high[lane] =
          std::min(packet_.lanes.t_high[lane],
                   static_cast<float>(visitors_[lane].t_limit() - packet_.lanes.t_shift[lane] + margin_.value));
    }
    return true;
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const Treelets& treelets_;
  const TreeMargin& margin_;
  const TreeletLeaf<Positions> leaf_;
  const Ray* rays_ = nullptr;
  FirstHitVisitor* visitors_ = nullptr;
  TreeletPacket packet_;
  float latest_ = 0.0f;
  std::uint32_t octant_active_ = 0;
  bool uniform_;
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
