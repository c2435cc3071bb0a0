// Sixteen coherent rays, and the beams around those of them that go down one octant: SIMD over the rays, and over the
// children of a node that a beam meets. Included once per SIMD target.
#if defined(INSITU_KERNELS_RAY_BEAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_RAY_BEAM_INL_H_
#undef INSITU_KERNELS_RAY_BEAM_INL_H_
#else
#define INSITU_KERNELS_RAY_BEAM_INL_H_
#endif

#include "kernels/node_planes-inl.h"
#include "kernels/pkd_enter-inl.h"

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
  HWY_INLINE void MakeBeam(std::uint32_t active, double margin, RayBeam& beam) {
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

  // The farthest distance that any ray of the beam still looks at.
  HWY_INLINE void UpdateLatest(RayBeam& beam) const {
    const D d;
    V latest = hn::Set(d, -1.0f);
    for (std::size_t i = 0; i < size; i += hn::Lanes(d))
      latest =
          hn::Max(latest, hn::IfThenElse(LanesOf(beam.active, i), hn::Load(d, lanes.t_high + i), hn::Set(d, -1.0f)));
    beam.latest = hn::GetLane(hn::MaxOfLanes(d, latest));
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

HWY_INLINE std::uint32_t MeetBeam(const NodePlanes& planes, const RayBeam& beam) {
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
HWY_INLINE bool MeetLanes(const NodePlanes& planes, unsigned k, const RayPacket& packet, std::uint32_t active) {
  const RayPacket::D d;
  using V = RayPacket::V;
  std::uint32_t met = 0;
  for (std::size_t i = 0; i < RayPacket::size; i += hn::Lanes(d)) {
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

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
