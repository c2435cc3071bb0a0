// What packets of coherent rays hit: SIMD over the rays of a packet, a particle at a time, and over all that is
// confirmed together. Included once per SIMD target.
#if defined(INSITU_KERNELS_PACKET_HITS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PACKET_HITS_INL_H_
#undef INSITU_KERNELS_PACKET_HITS_INL_H_
#else
#define INSITU_KERNELS_PACKET_HITS_INL_H_
#endif

#include "kernels/pkd_leaf-inl.h"
#include "kernels/pkd_visitors.h"
#include "kernels/ray_beam-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// The first hits of the packets of a stream: candidates are noted in f32, and confirmed by double arithmetic.
template <class Positions>
class PacketHits {
 public:
  PacketHits(const PkdTree& tree, const Positions& positions, const TreeMargin& margin)
      : tree_(tree), positions_(positions), margin_(margin), shrink_(margin.twice()) {}

  void Begin(const Ray* rays, Hit* hits) {
    rays_ = rays;
    hits_ = hits;
  }

  // Rays [first, first + count) of the stream, which packet.rays holds: where they enter the tree.
  HWY_INLINE void Enter(RayPacket& packet, std::size_t first, std::size_t count) const {
    NoteLimits(packet, hits_ + first, count);
    EnterTree(tree_, margin_, packet.rays, packet.limit, true, packet.lanes);
    packet.first_ray = static_cast<std::uint32_t>(first);
    packet.noted = 0;
    packet.here = HWY_UNLIKELY(tree_.continues) ? HitsHere(hits_ + first, count) : 0;
    const D d;
    const V shrink = hn::Set(d, shrink_);
    const std::uint32_t may_note = MayNote(rays_ + first, count);
    for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
      const V earliest = hn::Sub(hn::Load(d, packet.lanes.t_high + i), shrink);
      const V never = hn::Set(d, -std::numeric_limits<float>::infinity());
      hn::Store(hn::IfThenElse(RayPacket::LanesOf(may_note, i), earliest, never), d, packet.best_earliest + i);
      hn::Store(hn::Add(hn::Load(d, packet.lanes.t_low + i), shrink), d, packet.t_certain + i);
      if constexpr (Positions::is_exact_in_f32)  // lanes without a candidate are confirmed along, and left alone
        for (auto& centres : packet.best_centre) hn::Store(hn::Zero(d), d, centres + i);
    }
  }

  // True: a ray's limit has come nearer.
  //
  // In f32 a sphere that is grown by the margin is hit no later, and one that is shrunk by it no earlier, than the
  // sphere is in truth: the near intersection moves by at least the change of the radius. That bounds the distance of a
  // hit from both sides. While one candidate of a ray is nearer than all others, bounds and all, it is only noted;
  // where bounds overlap, double arithmetic decides at once.
  HWY_INLINE bool VisitParticle(RayPacket& packet, std::uint64_t place, const float centre[3], float radius,
                                std::uint32_t active) const {
    const D d;
    const hn::RebindToUnsigned<D> u;
    const std::size_t lanes = hn::Lanes(d);
    const V r2 = hn::Set(d, radius * radius * (1.0f + 1e-6f));
    const float inner = std::max(radius - shrink_, 0.0f);
    const V inner2 = hn::Set(d, inner * inner * (1.0f - 2e-6f));
    const V cx = hn::Set(d, centre[0]);
    const V cy = hn::Set(d, centre[1]);
    const V cz = hn::Set(d, centre[2]);
    bool nearer = false;
    for (std::size_t i = 0; i < size; i += lanes) {
      const auto [b, distance2] = ApproachOf(
          hn::Sub(cx, hn::Load(d, packet.lanes.origin[0] + i)), hn::Sub(cy, hn::Load(d, packet.lanes.origin[1] + i)),
          hn::Sub(cz, hn::Load(d, packet.lanes.origin[2] + i)), hn::Load(d, packet.lanes.direction[0] + i),
          hn::Load(d, packet.lanes.direction[1] + i), hn::Load(d, packet.lanes.direction[2] + i));
      const auto close = hn::Le(distance2, r2);
      if (hn::AllFalse(d, close)) continue;
      const V t_high = hn::Load(d, packet.lanes.t_high + i);
      const V t_low = hn::Load(d, packet.lanes.t_low + i);
      const V s = hn::Sqrt(hn::Max(hn::Sub(r2, distance2), hn::Zero(d)));
      const V enter = hn::Sub(b, s);
      const auto candidate = hn::And(hn::And(close, RayPacket::LanesOf(active, i)),
                                     hn::And(hn::Le(enter, t_high), hn::Ge(hn::Add(b, s), t_low)));
      if (hn::AllFalse(d, candidate)) continue;
      // A ray that starts within the sphere, shrunk as well as grown, leaves it instead.
      const V inner_s = hn::Sqrt(hn::Max(hn::Sub(inner2, distance2), hn::Zero(d)));
      const auto is_certain = hn::Lt(distance2, inner2);  // nothing hits a radius of 0
      const auto is_inside = hn::And(is_certain, hn::Le(hn::Sub(b, inner_s), t_low));
      const V earliest = hn::IfThenElse(is_inside, hn::Add(b, inner_s), enter);
      const V latest = hn::IfThenElse(is_inside, hn::Add(b, s), hn::Sub(b, inner_s));
      const auto possible = hn::And(candidate, hn::Le(earliest, t_high));
      const auto certain = hn::And(hn::And(is_certain, hn::Gt(earliest, hn::Load(d, packet.t_certain + i))),
                                   hn::Lt(latest, hn::Load(d, packet.best_earliest + i)));
      const auto wins = hn::And(possible, certain);
      hn::BlendedStore(latest, wins, d, packet.lanes.t_high + i);
      hn::BlendedStore(earliest, wins, d, packet.best_earliest + i);
      hn::BlendedStore(hn::Set(u, static_cast<std::uint32_t>(place)), hn::RebindMask(u, wins), u,
                       packet.best_place + i);
      if constexpr (Positions::is_exact_in_f32) {
        hn::BlendedStore(cx, wins, d, packet.best_centre[0] + i);
        hn::BlendedStore(cy, wins, d, packet.best_centre[1] + i);
        hn::BlendedStore(cz, wins, d, packet.best_centre[2] + i);
      }
      const std::uint32_t noted = MaskBits(d, wins) << i;
      packet.noted |= noted;
      if (!Positions::is_exact_in_f32 && HWY_UNLIKELY(tree_.copies.exist()) && noted != 0)
        positions_.prefetch(place);  // confirmed at the end
      nearer = true;
      for (std::uint32_t open = MaskBits(d, possible) << i & ~noted; open != 0; open &= open - 1) {
        const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(open);
        ConfirmNoted(packet, lane);
        Confirm(packet, lane, place);
      }
    }
    return nearer;
  }

  // All that is noted, after the walk, with the operations of sphere_first_hit() in their order.
  HWY_INLINE void ConfirmAllNoted(const RayPacket& packet) const {
    const hn::CappedTag<double, size> d;
    const hn::Rebind<float, decltype(d)> f;
    using W = hn::Vec<decltype(d)>;
    HWY_ALIGN double centre[3][size] = {};
    HWY_ALIGN double radius[size] = {};
    HWY_ALIGN double t[size];
    const bool uniform = tree_.radius.kind == RadiusView::Kind::uniform;
    if (!Positions::is_exact_in_f32 || !uniform) {
      for (std::uint32_t left = packet.noted; left != 0; left &= left - 1) {
        const std::size_t lane = first_of(left);
        const std::uint64_t place = packet.best_place[lane];
        radius[lane] = tree_.radius.value(tree_.item(place));
        if constexpr (!Positions::is_exact_in_f32) {
          double at[3];
          positions_.centre(place, at);
          for (std::size_t c = 0; c < 3; ++c) centre[c][lane] = at[c];
        }
      }
    }
    const auto centres = [&](std::size_t c, std::size_t i) HWY_ATTR {
      if constexpr (Positions::is_exact_in_f32) return hn::PromoteTo(d, hn::Load(f, packet.best_centre[c] + i));
      return hn::Load(d, centre[c] + i);
    };
    const W never = hn::Set(d, std::numeric_limits<double>::infinity());
    std::uint32_t nearer = 0;
    std::uint32_t equal = 0;
    for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
      const W dx = hn::Load(d, packet.rays.direction(0) + i);
      const W dy = hn::Load(d, packet.rays.direction(1) + i);
      const W dz = hn::Load(d, packet.rays.direction(2) + i);
      const W fx = hn::Sub(hn::Load(d, packet.rays.origin(0) + i), centres(0, i));
      const W fy = hn::Sub(hn::Load(d, packet.rays.origin(1) + i), centres(1, i));
      const W fz = hn::Sub(hn::Load(d, packet.rays.origin(2) + i), centres(2, i));
      const W b = hn::Neg(hn::Add(hn::Add(hn::Mul(fx, dx), hn::Mul(fy, dy)), hn::Mul(fz, dz)));
      const W px = hn::Add(fx, hn::Mul(b, dx));
      const W py = hn::Add(fy, hn::Mul(b, dy));
      const W pz = hn::Add(fz, hn::Mul(b, dz));
      const W r = uniform ? hn::Set(d, tree_.radius.uniform) : hn::Load(d, radius + i);
      const W discriminant =
          hn::Sub(hn::Mul(r, r), hn::Add(hn::Add(hn::Mul(px, px), hn::Mul(py, py)), hn::Mul(pz, pz)));
      const W s = hn::Sqrt(discriminant);
      const W enter = hn::Sub(b, s);
      const W leave = hn::Add(b, s);
      const W t_min = hn::Load(d, packet.rays.t_min() + i);
      const W later = hn::IfThenElse(hn::Gt(leave, t_min), leave, never);
      const W first = hn::IfThenElse(hn::Gt(enter, t_min), enter, later);
      const W at = hn::IfThenElse(hn::Ge(discriminant, hn::Zero(d)), first, never);
      const W limit = hn::Load(d, packet.limit + i);
      hn::Store(at, d, t + i);
      nearer |= MaskBits(d, hn::Lt(at, limit)) << i;
      equal |= MaskBits(d, hn::And(hn::Eq(at, limit), hn::Lt(at, never))) << i;
    }
    Hit* const hits = hits_ + packet.first_ray;
    for (std::uint32_t left = nearer & packet.noted; left != 0; left &= left - 1) {
      const std::size_t lane = first_of(left);
      hits[lane] = {t[lane], tree_.item(packet.best_place[lane])};
    }
    for (std::uint32_t left = equal & packet.noted; HWY_UNLIKELY(left != 0); left &= left - 1) {
      const std::size_t lane = first_of(left);
      FirstHitVisitor(rays_[packet.first_ray + lane], hits[lane], (packet.here >> lane & 1) != 0)
          .offer(tree_, tree_.item(packet.best_place[lane]), t[lane]);
    }
  }

 private:
  using D = RayPacket::D;
  using V = RayPacket::V;
  static constexpr std::size_t size = RayPacket::size;
  static constexpr std::uint64_t most_noted = std::uint64_t{1} << 32;

  HWY_NOINLINE std::uint32_t HitsHere(const Hit* hits, std::size_t count) const {
    std::uint32_t lanes = 0;
    for (std::size_t i = 0; i < count; ++i) lanes |= (is_own_hit(tree_, hits[i]) ? 1u : 0u) << i;
    return lanes;
  }

  // Behind what has been hit already, nothing counts.
  HWY_INLINE static void NoteLimits(RayPacket& packet, const Hit* hits, std::size_t count) {
    static_assert(offsetof(Hit, t) == 0 && sizeof(Hit) == 2 * sizeof(double));
    const hn::CappedTag<double, size> d;
    if (HWY_LIKELY(count == size)) {
      for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
        hn::Vec<decltype(d)> t, item;
        hn::LoadInterleaved2(d, reinterpret_cast<const double*>(hits + i), t, item);
        hn::Store(hn::Min(t, hn::Load(d, packet.rays.t_max() + i)), d, packet.limit + i);
      }
      return;
    }
    for (std::size_t i = 0; i < size; ++i)
      packet.limit[i] =
          i < count ? std::min(packet.rays.t_max()[i], hits[i].t) : -std::numeric_limits<double>::infinity();
  }

  // Whether a candidate is the excluded item is left to the confirmation; places are noted in 32 bits.
  HWY_INLINE std::uint32_t MayNote(const Ray* rays, std::size_t count) const {
    if (HWY_UNLIKELY(tree_.count > most_noted)) return 0;
    std::uint64_t all = no_item;  // all bits are set
    for (std::size_t i = 0; i < count; ++i) all &= rays[i].exclude;
    std::uint32_t lanes = (std::uint32_t{1} << count) - 1;
    if (HWY_UNLIKELY(all != no_item))
      for (std::size_t i = 0; i < count; ++i)
        if (rays[i].exclude != no_item) lanes &= ~(1u << i);
    return lanes;
  }

  void Confirm(RayPacket& packet, std::size_t lane, std::uint64_t place) const {
    const Ray& ray = rays_[packet.first_ray + lane];
    FirstHitVisitor visitor(ray, hits_[packet.first_ray + lane], (packet.here >> lane & 1) != 0);
    visitor.visit(tree_, positions_, place, ray);
    packet.here |= (visitor.is_here() ? 1u : 0u) << lane;
    packet.limit[lane] = visitor.t_limit();
    const double t = visitor.t_limit() - packet.lanes.t_shift[lane];
    packet.lanes.t_high[lane] = std::min(packet.lanes.t_high[lane], static_cast<float>(t + margin_.value));
    if (MayNote(&ray, 1) != 0) packet.best_earliest[lane] = static_cast<float>(t - margin_.value);
  }
  static HWY_INLINE std::size_t first_of(std::uint32_t lanes) { return hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes); }

  void ConfirmNoted(RayPacket& packet, std::size_t lane) const {
    if ((packet.noted >> lane & 1) == 0) return;
    packet.noted &= ~(1u << lane);
    Confirm(packet, lane, packet.best_place[lane]);
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const TreeMargin& margin_;
  const float shrink_;  // two margins
  const Ray* rays_ = nullptr;
  Hit* hits_ = nullptr;
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
