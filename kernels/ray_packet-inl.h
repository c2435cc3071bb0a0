// Packets of coherent rays: SIMD over the children of a node for the beam around the rays, and over the rays for the
// leaves that the beam meets; in leaves likewise for particles. Included once per SIMD target.
#if defined(INSITU_KERNELS_RAY_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_RAY_PACKET_INL_H_
#undef INSITU_KERNELS_RAY_PACKET_INL_H_
#else
#define INSITU_KERNELS_RAY_PACKET_INL_H_
#endif

#include "kernels/particle_tests-inl.h"
#include "kernels/pkd_enter-inl.h"
#include "kernels/pkd_single-inl.h"
#include "kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// Rays of one octant that start close to each other, and the beam around them, two ways:
//   - as an interval of rays: a box that no ray of the interval meets is met by none of the packet (Reshetov, Soupikov,
//     Hurley, "Multi-level ray tracing algorithm", SIGGRAPH 2005). For t >= 0 near planes are met no earlier than by
//     the origin nearest to them with the smallest slowness, far planes left no later than by the opposite.
//   - as a cone: the point of a ray at distance t is within start + growth t of the axis' own point at t. Of a particle
//     of radius r at b along the axis, a ray is within r at a t of at most (b + r + start) / (1 - growth).
struct RayBeam {
  float near_start[3];
  float near_inverse[3];
  float far_start[3];
  float far_inverse[3];
  float origin[3];
  float direction[3];
  float start;
  float growth;
  float stretch;    // 1 / (1 - growth)
  float begin;      // the least t_low of its rays
  float uncertain;  // by how much the points where they begin may be off the axis' point there
  float latest;     // the farthest distance that any of its rays still looks at
  std::uint32_t packet;
  std::uint32_t active;  // its rays
};

class RayPacket {
 public:
  static constexpr std::size_t size = EnteredRays::size;

  RayColumns rays;
  EnteredRays lanes;
  HWY_ALIGN float start[3][size];  // - origin / direction
  // Candidates noted in f32, a lane each: earliest and, as lanes.t_high, latest distance; of lanes in `noted`.
  HWY_ALIGN float best_earliest[size];
  HWY_ALIGN float t_certain[size];  // candidates begin behind it
  HWY_ALIGN std::uint32_t best_place[size];
  HWY_ALIGN float best_centre[3][size];
  HWY_ALIGN double limit[size];  // of the ray as it is: what has been confirmed is not behind it
  std::uint32_t noted;
  std::uint32_t here;  // lanes whose hits are of this tree
  std::uint32_t first_ray;

  // Of the rays of `active`, all of one octant.
  void MakeBeam(std::uint32_t active, double margin, RayBeam& beam) {
    const D d;
    const std::size_t n = hn::Lanes(d);
    // The axis lies between the first and the last of the rays: opposite corners, when they come from a square of
    // pixels.
    const auto first = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(active));
    const auto last = static_cast<std::size_t>(31 - hwy::Num0BitsAboveMS1Bit_Nonzero32(active));
    float squared_length = 0.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      V o_low, o_high, v_low, v_high;
      for (std::size_t i = 0; i < size; i += n) {
        const V origins = hn::Load(d, lanes.origin[c] + i);
        const V inverses = hn::Load(d, lanes.inverse[c] + i);
        hn::Store(hn::Neg(hn::Mul(origins, inverses)), d, start[c] + i);
        // Other lanes count as the first.
        const auto is_active = LanesOf(active, i);
        const V o = hn::IfThenElse(is_active, origins, hn::Set(d, lanes.origin[c][first]));
        const V v = hn::IfThenElse(is_active, inverses, hn::Set(d, lanes.inverse[c][first]));
        o_low = i == 0 ? o : hn::Min(o_low, o);
        o_high = i == 0 ? o : hn::Max(o_high, o);
        v_low = i == 0 ? v : hn::Min(v_low, v);
        v_high = i == 0 ? v : hn::Max(v_high, v);
      }
      float least[4];
      LeastOfFour(d, o_low, hn::Neg(o_high), v_low, hn::Neg(v_high), least);
      const float low = least[0];
      const float high = -least[1];
      const float slowest = least[2];
      const float fastest = -least[3];
      const bool is_up = slowest >= 0.0f;
      beam.near_inverse[c] = is_up ? slowest : fastest;
      beam.far_inverse[c] = is_up ? fastest : slowest;
      beam.near_start[c] = -(is_up ? high : low) * beam.near_inverse[c];
      beam.far_start[c] = -(is_up ? low : high) * beam.far_inverse[c];
      beam.origin[c] = 0.5f * (lanes.origin[c][first] + lanes.origin[c][last]);
      beam.direction[c] = lanes.direction[c][first] + lanes.direction[c][last];
      squared_length += beam.direction[c] * beam.direction[c];
    }
    const float length = std::sqrt(squared_length);
    for (float& component : beam.direction) component /= length;
    // Whatever the axis is, the bounds are measured from it. The factors cover the rounding of the measurement.
    V offsets = hn::Zero(d);
    V slopes = hn::Zero(d);
    V begins_low, begins_high;
    for (std::size_t i = 0; i < size; i += n) {
      V offset = hn::Zero(d);
      V slope = hn::Zero(d);
      for (std::size_t c = 0; c < 3; ++c) {
        const V apart = hn::Sub(hn::Load(d, lanes.origin[c] + i), hn::Set(d, beam.origin[c]));
        const V turned = hn::Sub(hn::Load(d, lanes.direction[c] + i), hn::Set(d, beam.direction[c]));
        offset = hn::MulAdd(apart, apart, offset);
        slope = hn::MulAdd(turned, turned, slope);
      }
      const auto is_active = LanesOf(active, i);
      const V begins = hn::IfThenElse(is_active, hn::Load(d, lanes.t_low + i), hn::Set(d, lanes.t_low[first]));
      offsets = hn::Max(offsets, hn::IfThenElseZero(is_active, offset));
      slopes = hn::Max(slopes, hn::IfThenElseZero(is_active, slope));
      begins_low = i == 0 ? begins : hn::Min(begins_low, begins);
      begins_high = i == 0 ? begins : hn::Max(begins_high, begins);
    }
    float least[4];
    LeastOfFour(d, hn::Neg(offsets), hn::Neg(slopes), begins_low, hn::Neg(begins_high), least);
    beam.start = std::sqrt(-least[0]) * (1.0f + 1e-5f) + static_cast<float>(margin);
    beam.growth = std::sqrt(-least[1]) * (1.0f + 1e-5f);
    beam.begin = least[2];
    const float apart = -least[3] - beam.begin;
    beam.uncertain = apart + beam.growth * (std::abs(beam.begin) + apart);
    beam.stretch = 1.0f / (1.0f - beam.growth);
    if (beam.growth > 0.5f) {
      // Rays that go very different ways: everything is within their cone.
      beam.start = 1e18f;
      beam.growth = 0.0f;
      beam.stretch = 1.0f;
    }
  }

  using D = hn::CappedTag<float, size>;
  using V = hn::Vec<D>;

  // The least lane of each of four vectors: together, for what is left of each is soon a part of a vector only.
  static HWY_INLINE void LeastOfFour(D d, V v0, V v1, V v2, V v3, float (&least)[4]) {
#if HWY_TARGET != HWY_SCALAR
    if constexpr (hn::MaxLanes(D()) == 16) {
      const V low = hn::Min(hn::ConcatLowerLower(d, v1, v0), hn::ConcatUpperUpper(d, v1, v0));
      const V high = hn::Min(hn::ConcatLowerLower(d, v3, v2), hn::ConcatUpperUpper(d, v3, v2));
      const V all = hn::Min(hn::OddEvenBlocks(hn::SwapAdjacentBlocks(high), low),
                            hn::OddEvenBlocks(high, hn::SwapAdjacentBlocks(low)));
      const V pairs = hn::Min(all, hn::Shuffle2301(all));
      HWY_ALIGN float blocks[4][4];
      hn::Store(hn::Min(pairs, hn::Shuffle1032(pairs)), d, blocks[0]);
      least[0] = blocks[0][0];
      least[1] = blocks[2][0];
      least[2] = blocks[1][0];
      least[3] = blocks[3][0];
      return;
    }
#endif
    least[0] = hn::GetLane(hn::MinOfLanes(d, v0));
    least[1] = hn::GetLane(hn::MinOfLanes(d, v1));
    least[2] = hn::GetLane(hn::MinOfLanes(d, v2));
    least[3] = hn::GetLane(hn::MinOfLanes(d, v3));
  }

  // The rays that go down axis c.
  std::uint32_t Negative(std::size_t c) const {
    const D d;
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < size; i += hn::Lanes(d))
      bits |= MaskBits(d, hn::Lt(hn::Load(d, lanes.inverse[c] + i), hn::Zero(d))) << i;
    return bits;
  }

  static HWY_INLINE hn::Mask<D> LanesOf(std::uint32_t active, std::size_t first) {
    const std::uint64_t bits = active >> first;
    std::uint8_t bytes[sizeof bits];
    std::memcpy(bytes, &bits, sizeof bits);
    return hn::LoadMaskBits(D(), bytes);
  }
};

// The items of a walk: beams, each of the rays of one packet that go down one octant. First hits; double arithmetic
// decides.
template <class Positions>
class StreamPackets {
 public:
  static constexpr std::size_t size = EnteredRays::size;
  static constexpr std::size_t most_octants = 8;
  static constexpr bool is_indirect = Positions::is_indirect;

  StreamPackets(const PkdTree& tree, const Positions& positions, const TreeMargin& margin, bool copied,
                std::size_t most_rays)
      : tree_(tree),
        positions_(positions),
        margin_(margin),
        copied_(copied),
        tests_(tree, margin.value),
        shrink_(static_cast<float>(2.0 * margin.value * (1.0 + 1e-3))),
        packets_(new RayPacket[(most_rays + size - 1) / size]),
        beams_(new RayBeam[most_octants * ((most_rays + size - 1) / size)]) {}

  // Packets of rays[0 .. count). A beam of octant o is put down by add(o, beam).
  template <class AddBeam>
  void Enter(const Ray* rays, Hit* hits, std::size_t count, const AddBeam& add) {
    rays_ = rays;
    hits_ = hits;
    std::uint32_t beams = 0;
    packet_count_ = 0;
    for (std::size_t first = 0; first < count; first += size) {
      // The rays of the packet after the next.
      prefetch_bytes(rays + std::min(first + 2 * size, count), size * sizeof(Ray));
      RayPacket& packet = packets_[packet_count_];
      if (!EnterPacket(packet, first, std::min(size, count - first))) continue;
      std::uint32_t signs[3];
      for (std::size_t c = 0; c < 3; ++c) signs[c] = packet.Negative(c);
      for (std::uint32_t left = packet.lanes.inside; left != 0;) {
        const auto lane = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(left));
        std::uint32_t active = left;
        std::uint32_t octant = 0;
        for (std::uint32_t c = 0; c < 3; ++c) {
          const bool is_down = (signs[c] >> lane & 1) != 0;
          active &= is_down ? signs[c] : ~signs[c];
          octant |= is_down ? 1u << c : 0u;
        }
        left &= ~active;
        RayBeam& beam = beams_[beams];
        packet.MakeBeam(active, margin_.value, beam);
        beam.packet = static_cast<std::uint32_t>(packet_count_);
        beam.active = active;
        UpdateLatest(beam);
        add(octant, beams++);
      }
      ++packet_count_;
    }
  }

  // After the walk: what has been noted is confirmed, all of a packet together, with the operations of sphere.h in
  // their order: the same bits as sphere_first_hit.
  void Finish() {
    for (std::size_t i = 0; i < packet_count_; ++i)
      if (packets_[i].noted != 0) ConfirmAllNoted(packets_[i]);
  }

  HWY_INLINE std::uint32_t Meet(const NodePlanes& planes, std::uint32_t item, bool is_last) const {
    const RayBeam& beam = beams_[item];
    std::uint32_t met = MeetBeam(planes, beam);
    if (!is_last) return met;
    // Before a leaf is visited: does any ray of the beam meet it?
    std::uint32_t met_by_rays = 0;
    for (; met != 0; met &= met - 1) {
      const auto k = static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(met));
      met_by_rays |= MeetLanes(planes, k, packets_[beam.packet], beam.active) ? 1u << k : 0u;
    }
    return met_by_rays;
  }

  // A packet is looked for in all of a node's children before any of its rays is done.
  static constexpr std::size_t done() { return 0; }
  static std::size_t KeepOpen(std::uint32_t*, std::size_t count) { return count; }

  HWY_INLINE void Prefetch(std::uint64_t begin, std::uint64_t end) const {
    if (HWY_UNLIKELY(!tree_.selected.all())) return PrefetchDrawn(tree_, positions_, begin, end, copied_);
    positions_.prefetch_run(begin, end);
  }
  HWY_INLINE void PrefetchBehind(std::uint64_t begin, std::uint64_t end) const {
    if (HWY_UNLIKELY(!tree_.selected.all())) return PrefetchDrawnBehind(tree_, positions_, begin, end, copied_);
    PrefetchRunBehind(positions_, begin, end);
  }

  HWY_INLINE void Visit(std::uint64_t begin, std::uint64_t end, std::uint32_t* list, std::size_t count) {
    if (HWY_UNLIKELY(!tree_.selected.all())) return VisitFiltered(begin, end, list, count);
    Visit(ParticleRun<Positions>(tree_, positions_, begin, end), list, count);
  }
  HWY_INLINE void VisitPick(const ParticlePick& pick, std::uint32_t* list, std::size_t count) {
    Visit(pick, list, count);
  }

 private:
  using D = hn::CappedTag<float, size>;
  using V = hn::Vec<D>;
  static constexpr std::uint64_t most_noted = std::uint64_t{1} << 32;

  // Not inlined: without a filter it is never called.
  HWY_NOINLINE void VisitFiltered(std::uint64_t begin, std::uint64_t end, std::uint32_t* list, std::size_t count) {
    VisitDrawn(tree_, positions_, begin, end, copied_,
               [&](const auto& particles) HWY_ATTR { Visit(particles, list, count); });
  }

  template <class Particles>
  HWY_INLINE void Visit(const Particles& particles, std::uint32_t* list, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      RayBeam& beam = beams_[list[i]];
      RayPacket& packet = packets_[beam.packet];
      bool changed = false;
      tests_.VisitWithinBeam(
          particles, beam,
          [&](std::uint64_t place, const float centre[3], float radius)
              HWY_ATTR { changed |= VisitParticle(packet, place, centre, radius, beam.active); },
          [&]() HWY_ATTR {
            if (changed) UpdateLatest(beam);
            changed = false;
          });
    }
  }

  // False: the rays come from too far away, and have been traced one by one.
  bool EnterPacket(RayPacket& packet, std::size_t first, std::size_t count) {
    packet.rays.Load(rays_ + first, count);
    if (HWY_UNLIKELY(!packet.rays.StartWithin(margin_.farthest))) {
      for (std::size_t i = first; i < first + count; ++i) {
        FirstHitVisitor visitor(rays_[i], hits_[i], is_own_hit(tree_, hits_[i]));
        TraverseTree(tree_, positions_, rays_[i], visitor);
      }
      return false;
    }
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
      for (auto& centres : packet.best_centre) hn::Store(hn::Zero(d), d, centres + i);
    }
    return true;
  }

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

  HWY_INLINE static std::uint32_t MeetBeam(const NodePlanes& planes, const RayBeam& beam) {
    const hn::CappedTag<float, node_fanout> d;
    using W = hn::Vec<decltype(d)>;
    std::uint32_t met = 0;
    for (std::size_t k = 0; k < node_fanout; k += hn::Lanes(d)) {
      W enter = hn::Zero(d);
      W leave = hn::Set(d, beam.latest);
      for (std::size_t c = 0; c < 3; ++c) {
        enter = hn::Max(enter, hn::MulAdd(hn::Load(d, planes.near[c] + k), hn::Set(d, beam.near_inverse[c]),
                                          hn::Set(d, beam.near_start[c])));
        leave = hn::Min(leave, hn::MulAdd(hn::Load(d, planes.far[c] + k), hn::Set(d, beam.far_inverse[c]),
                                          hn::Set(d, beam.far_start[c])));
      }
      met |= MaskBits(d, hn::Le(enter, leave)) << k;
    }
    return met;
  }

  // Any of the rays `active` meets child k.
  HWY_INLINE static bool MeetLanes(const NodePlanes& planes, unsigned k, const RayPacket& packet,
                                   std::uint32_t active) {
    const D d;
    std::uint32_t met = 0;
    for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
      V enter = hn::Zero(d);
      V leave = hn::Load(d, packet.lanes.t_high + i);
      for (std::size_t c = 0; c < 3; ++c) {
        const V inverse = hn::Load(d, packet.lanes.inverse[c] + i);
        const V start = hn::Load(d, packet.start[c] + i);
        enter = hn::Max(enter, hn::MulAdd(hn::Set(d, planes.near[c][k]), inverse, start));
        leave = hn::Min(leave, hn::MulAdd(hn::Set(d, planes.far[c][k]), inverse, start));
      }
      met |= MaskBits(d, hn::Le(enter, leave)) << i;
    }
    return (met & active) != 0;
  }

  // The farthest distance that any ray still looks at.
  HWY_INLINE void UpdateLatest(RayBeam& beam) const {
    const RayPacket& packet = packets_[beam.packet];
    const D d;
    V latest = hn::Set(d, -1.0f);
    for (std::size_t i = 0; i < size; i += hn::Lanes(d))
      latest = hn::Max(latest, hn::IfThenElse(RayPacket::LanesOf(beam.active, i), hn::Load(d, packet.lanes.t_high + i),
                                              hn::Set(d, -1.0f)));
    beam.latest = hn::GetLane(hn::MaxOfLanes(d, latest));
  }

  // True: a ray's limit has come nearer.
  //
  // In f32 a sphere that is grown by the margin is hit no later, and one that is shrunk by it no earlier, than the
  // sphere is in truth: the near intersection moves by at least the change of the radius. That bounds the distance of a
  // hit from both sides. While one candidate of a ray is nearer than all others, bounds and all, it is only noted;
  // where bounds overlap, double arithmetic decides at once.
  HWY_INLINE bool VisitParticle(RayPacket& packet, std::uint64_t place, const float centre[3], float radius,
                                std::uint32_t active) {
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
      const auto is_certain = hn::Le(distance2, inner2);
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

  void Confirm(RayPacket& packet, std::size_t lane, std::uint64_t place) {
    const Ray& ray = rays_[packet.first_ray + lane];
    FirstHitVisitor visitor(ray, hits_[packet.first_ray + lane], (packet.here >> lane & 1) != 0);
    visitor.visit(tree_, positions_, place, ray);
    packet.here |= (visitor.is_here() ? 1u : 0u) << lane;
    packet.limit[lane] = visitor.t_limit();
    const double t = visitor.t_limit() - packet.lanes.t_shift[lane];
    packet.lanes.t_high[lane] = std::min(packet.lanes.t_high[lane], static_cast<float>(t + margin_.value));
    if (MayNote(&ray, 1) != 0) packet.best_earliest[lane] = static_cast<float>(t - margin_.value);
  }
  // All that is noted, with the operations of sphere_first_hit() in their order.
  HWY_INLINE void ConfirmAllNoted(const RayPacket& packet) {
    const hn::CappedTag<double, size> d;
    const hn::Rebind<float, decltype(d)> f;
    using W = hn::Vec<decltype(d)>;
    HWY_ALIGN double centre[3][size];
    HWY_ALIGN double radius[size];
    HWY_ALIGN double t[size];
    const bool uniform = tree_.radius.kind == RadiusView::Kind::uniform;
    if (!Positions::is_exact_in_f32 || !uniform) {
      for (std::size_t lane = 0; lane < size; ++lane) {
        const std::uint64_t place = packet.best_place[(packet.noted >> lane & 1) != 0 ? lane : first_of(packet.noted)];
        double at[3];
        if (!Positions::is_exact_in_f32) positions_.centre(place, at);
        for (std::size_t c = 0; c < 3; ++c) centre[c][lane] = at[c];
        radius[lane] = tree_.radius.value(tree_.item(place));
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
  static HWY_INLINE std::size_t first_of(std::uint32_t lanes) { return hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes); }

  void ConfirmNoted(RayPacket& packet, std::size_t lane) {
    if ((packet.noted >> lane & 1) == 0) return;
    packet.noted &= ~(1u << lane);
    Confirm(packet, lane, packet.best_place[lane]);
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const TreeMargin& margin_;
  const bool copied_;  // the leaves of the walk are runs of copies
  const ParticleTests tests_;
  const float shrink_;  // two margins
  const Ray* rays_ = nullptr;
  Hit* hits_ = nullptr;
  std::size_t packet_count_ = 0;
  std::unique_ptr<RayPacket[]> packets_;
  std::unique_ptr<RayBeam[]> beams_;
};

constexpr std::size_t longest_packet_stream = 1024;

// First hits of coherent rays.
template <class Nodes, class Positions>
class FirstHitStream {
 public:
  FirstHitStream(const PkdTree& tree, const Positions& positions, const Nodes& nodes, const TreeMargin& margin,
                 std::size_t most_rays)
      : packets_(tree, positions, margin, nodes.are_copied(), most_rays),
        walks_(nodes, packets_, 8 * most_rays / 16 + 8) {}

  // rays[0 .. count), at most longest_packet_stream.
  void Run(const Ray* rays, Hit* hits, std::size_t count) {
    std::size_t sizes[8] = {};
    packets_.Enter(rays, hits, count, [&](std::uint32_t octant, std::uint32_t beam) {
      if (octant_of_.size() <= beam) octant_of_.resize(beam + 1);
      octant_of_[beam] = static_cast<std::uint8_t>(octant);
      ++sizes[octant];
      beams_ = beam + 1;
    });
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      if (sizes[octant] == 0) continue;
      std::uint32_t* list = walks_.Add(octant, sizes[octant]);
      for (std::uint32_t i = 0; i < beams_; ++i)
        if (octant_of_[i] == octant) *list++ = i;
    }
    beams_ = 0;
    walks_.Run();
    packets_.Finish();
  }

 private:
  using Packets = StreamPackets<Positions>;
  Packets packets_;
  Walks<Nodes, Packets> walks_;
  std::vector<std::uint8_t> octant_of_;
  std::uint32_t beams_ = 0;
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
