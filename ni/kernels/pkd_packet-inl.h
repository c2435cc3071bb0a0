// Packets of rays through a P-k-d tree: SIMD over rays while many of them go the same way, single rays below that.
// Included once per SIMD target.
#if defined(INSITU_KERNELS_PKD_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PKD_PACKET_INL_H_
#undef INSITU_KERNELS_PKD_PACKET_INL_H_
#else
#define INSITU_KERNELS_PKD_PACKET_INL_H_
#endif

#include "kernels/pkd_enter-inl.h"
#include "kernels/pkd_single-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

constexpr std::size_t packet_size = EnteredRays::size;

// Fewer rays than this go on one by one, with SIMD over particles.
constexpr int fewest_together = 4;

// Rays as EnterTree makes them. Where their entries are close to each other, as those of camera rays are, they form a
// beam: at every distance t from there they stay within beam_start + beam_growth t of its axis, the mean of the rays. A
// particle whose distance from the axis is above its radius plus that is hit by none of them.
class RayPacket {
 public:
  static constexpr std::size_t size = packet_size;

  // Takes rays[0 .. count).
  void Load(const PkdTree& tree, const TreeMargin& margin, const Ray* rays, std::size_t count, const double* t_limits) {
    margin_ = margin.value;
    const bool together = EnterTree(tree, margin, rays, t_limits, count, true, lanes_);
    FindSigns();
    has_beam_ = together && MakeBeam();
  }

  bool has_beam() const { return has_beam_; }
  // The axis as a ray without limits, for VisitLeaf-like tests.
  const float* beam_origin() const { return beam_origin_; }
  const float* beam_direction() const { return beam_direction_; }
  float beam_radius(float t_leave) const { return beam_start_ + beam_growth_ * t_leave; }
  // Most rays go down this axis.
  bool negative(int axis) const { return negative_[axis]; }
  // All of them go the same way.
  bool uniform_sign(int axis) const { return uniform_sign_[axis]; }

  double margin() const { return margin_; }
  const float* origin(int axis) const { return lanes_.origin[axis]; }
  const float* direction(int axis) const { return lanes_.direction[axis]; }
  const float* inverse(int axis) const { return lanes_.inverse[axis]; }
  const float* widening(int axis) const { return lanes_.widening[axis]; }
  const float* t_enter() const { return lanes_.t_enter; }
  const float* t_low() const { return lanes_.t_low; }
  const float* t_high() const { return lanes_.t_high; }  // nothing behind it counts: shrinks with every hit

  void LimitLane(std::size_t lane, double t) {
    lanes_.t_high[lane] = std::min(lanes_.t_high[lane], static_cast<float>(t - lanes_.t_shift[lane] + margin_));
  }
  void EndLane(std::size_t lane) { lanes_.t_high[lane] = -1e30f; }

  RayFrame FrameOf(std::size_t lane) const {
    RayFrame frame = {};
    for (int c = 0; c < 3; ++c) {
      frame.head[c] = lanes_.origin[c][lane];
      frame.point[c] = static_cast<double>(lanes_.origin[c][lane]);
      frame.direction[c] = lanes_.direction[c][lane];
    }
    frame.scale = 1.0;
    frame.margin = margin_;
    frame.t_shift = lanes_.t_shift[lane];
    frame.t_low = lanes_.t_low[lane];
    return frame;
  }
  SlabRay<float> SlabOf(std::size_t lane) const {
    SlabRay<float> slab;
    for (int c = 0; c < 3; ++c) {
      slab.origin[c] = lanes_.origin[c][lane];
      slab.inverse[c] = lanes_.inverse[c][lane];
      slab.widening[c] = lanes_.widening[c][lane];
      slab.negative[c] = lanes_.inverse[c][lane] < 0.0f;
    }
    return slab;
  }

 private:
  using D = hn::CappedTag<float, size>;
  using V = hn::Vec<D>;

  void FindSigns() {
    const D d;
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint32_t negative = 0;
      for (std::size_t i = 0; i < size; i += hn::Lanes(d))
        negative |= MaskBits(d, hn::Lt(hn::Load(d, lanes_.inverse[c] + i), hn::Zero(d))) << i;
      negative &= lanes_.inside;
      negative_[c] = 2 * hwy::PopCount(negative) > hwy::PopCount(lanes_.inside);
      uniform_sign_[c] = negative == 0 || negative == lanes_.inside;
    }
  }

  // False: the rays go too different ways. Lanes without a ray hold zeros.
  bool MakeBeam() {
    const D d;
    const float rays = static_cast<float>(hwy::PopCount(lanes_.inside));
    float squared_length = 0.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      V origins = hn::Zero(d);
      V directions = hn::Zero(d);
      for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
        origins = hn::Add(origins, hn::Load(d, lanes_.origin[c] + i));
        directions = hn::Add(directions, hn::Load(d, lanes_.direction[c] + i));
      }
      beam_origin_[c] = hn::GetLane(hn::SumOfLanes(d, origins)) / rays;
      beam_direction_[c] = hn::GetLane(hn::SumOfLanes(d, directions));
      squared_length += beam_direction_[c] * beam_direction_[c];
    }
    const float length = std::sqrt(squared_length);
    if (!(length > 0.9f * rays)) return false;
    for (float& component : beam_direction_) component /= length;
    // Whatever the axis is, the bounds are measured from it. The factors cover the rounding of the measurement.
    V start = hn::Zero(d);
    V growth = hn::Zero(d);
    for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
      V offset = hn::Zero(d);
      V slope = hn::Zero(d);
      for (std::size_t c = 0; c < 3; ++c) {
        const V apart = hn::Sub(hn::Load(d, lanes_.origin[c] + i), hn::Set(d, beam_origin_[c]));
        const V turned = hn::Sub(hn::Load(d, lanes_.direction[c] + i), hn::Set(d, beam_direction_[c]));
        offset = hn::MulAdd(apart, apart, offset);
        slope = hn::MulAdd(turned, turned, slope);
      }
      const auto is_inside = hn::Le(hn::Load(d, lanes_.t_enter + i), hn::Load(d, lanes_.t_high + i));
      start = hn::Max(start, hn::IfThenElseZero(is_inside, offset));
      growth = hn::Max(growth, hn::IfThenElseZero(is_inside, slope));
    }
    beam_start_ = std::sqrt(hn::GetLane(hn::MaxOfLanes(d, start))) * (1.0f + 1e-5f) + static_cast<float>(margin_);
    beam_growth_ = std::sqrt(hn::GetLane(hn::MaxOfLanes(d, growth))) * (1.0f + 1e-5f);
    return true;
  }

  EnteredRays lanes_;
  double margin_;
  bool has_beam_;
  bool negative_[3];
  bool uniform_sign_[3];
  float beam_origin_[3];
  float beam_direction_[3];
  float beam_start_;
  float beam_growth_;
};

template <class Key>
struct PacketSubtree {
  HWY_ALIGN float t_enter[packet_size];
  HWY_ALIGN float t_leave[packet_size];
  std::uint64_t begin;
  std::uint64_t end;
  PkdBox<Key> box;
};

template <class Positions, class Visitor>
class PacketTraversal {
 public:
  using Key = typename Positions::Key;

  PacketTraversal(const PkdTree& tree, const Positions& positions, const Ray* rays, RayPacket& packet,
                  Visitor* visitors)
      : tree_(tree), positions_(positions), rays_(rays), packet_(packet), visitors_(visitors) {
    const double r = tree.radius.uniform + packet.margin();
    uniform_ = tree.radius.kind == RadiusView::Kind::uniform;
    radius2_ = static_cast<float>(r * r * (1.0 + 8.0 * f32_unit));
  }

  HWY_INLINE void Run() {
    PacketSubtree<Key> stack[64];
    PacketSubtree<Key> now;
    now.begin = 0;
    now.end = tree_.count;
    now.box = RootBox<Key>(tree_);
    std::memcpy(now.t_enter, packet_.t_enter(), sizeof now.t_enter);
    std::memcpy(now.t_leave, packet_.t_high(), sizeof now.t_leave);
    std::uint32_t active = ActiveLanes(now);
    int height = 0;
    for (;;) {
      while (active != 0) {
        if (hwy::PopCount(active) < fewest_together) {
          VisitOneByOne(now, active);
          break;
        }
        if (now.end - now.begin <= pkd_leaf_size || now.box.is_point()) {
          VisitTogether(now, active);
          break;
        }
        const int axis = now.box.split_axis();
        const std::uint64_t mid = now.begin + (now.end - now.begin) / 2;
        const Key plane = positions_.key(mid, axis);
        const bool far_is_lower = packet_.negative(axis);
        PacketSubtree<Key>& far = stack[height];
        std::uint32_t far_active = 0;
        const std::uint32_t near_active = Split(now, far, axis, static_cast<float>(plane), far_active);
        const std::uint32_t crossing = near_active & far_active;
        if (crossing != 0) VisitParticle(mid, crossing);
        far.begin = far_is_lower ? now.begin : mid + 1;
        far.end = far_is_lower ? mid : now.end;
        far.box = now.box;
        if (far_is_lower) {
          far.box.upper[axis] = plane;
          now.box.lower[axis] = plane;
          now.begin = mid + 1;
        } else {
          far.box.lower[axis] = plane;
          now.box.upper[axis] = plane;
          now.end = mid;
        }
        if (near_active == 0) {
          now = far;
          active = far_active;
        } else {
          if (far_active != 0) ++height;
          active = near_active;
        }
      }
      do {
        if (height == 0) return;
        now = stack[--height];
        active = ActiveLanes(now);
      } while (active == 0);
    }
  }

 private:
  using D = hn::CappedTag<float, packet_size>;
  using V = hn::Vec<D>;

  // What the near and the far side see of the rays: `now` becomes the near one. Returns the lanes that enter it.
  HWY_INLINE std::uint32_t Split(PacketSubtree<Key>& now, PacketSubtree<Key>& far, int axis, float plane,
                                 std::uint32_t& far_active) const {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    const V at = hn::Set(d, plane);
    const V zero = hn::Zero(d);
    std::uint32_t near_active = 0;
    for (std::size_t i = 0; i < packet_size; i += lanes) {
      const V inverse = hn::Load(d, packet_.inverse(axis) + i);
      const V at_plane = hn::Mul(hn::Sub(at, hn::Load(d, packet_.origin(axis) + i)), inverse);
      const V widening = hn::Load(d, packet_.widening(axis) + i);
      const V enter = hn::Load(d, now.t_enter + i);
      const V leave = hn::Load(d, now.t_leave + i);
      V near_enter = enter;
      V near_leave = hn::Min(leave, hn::Add(at_plane, widening));
      V far_enter = hn::Max(enter, hn::Sub(at_plane, widening));
      V far_leave = leave;
      if (HWY_UNLIKELY(!packet_.uniform_sign(axis))) {
        // Rays that go the other way have near and far exchanged.
        const auto other = packet_.negative(axis) ? hn::Ge(inverse, zero) : hn::Lt(inverse, zero);
        const V enter_there = near_enter;
        const V leave_there = near_leave;
        near_enter = hn::IfThenElse(other, far_enter, near_enter);
        near_leave = hn::IfThenElse(other, far_leave, near_leave);
        far_enter = hn::IfThenElse(other, enter_there, far_enter);
        far_leave = hn::IfThenElse(other, leave_there, far_leave);
        hn::Store(near_enter, d, now.t_enter + i);
      }
      hn::Store(near_leave, d, now.t_leave + i);
      hn::Store(far_enter, d, far.t_enter + i);
      hn::Store(far_leave, d, far.t_leave + i);
      near_active |= MaskBits(d, hn::Le(near_enter, near_leave)) << i;
      far_active |= MaskBits(d, hn::Le(far_enter, far_leave)) << i;
    }
    return near_active;
  }

  // Takes hits found meanwhile into account.
  HWY_INLINE std::uint32_t ActiveLanes(PacketSubtree<Key>& subtree) const {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    std::uint32_t active = 0;
    for (std::size_t i = 0; i < packet_size; i += lanes) {
      const V leave = hn::Min(hn::Load(d, subtree.t_leave + i), hn::Load(d, packet_.t_high() + i));
      hn::Store(leave, d, subtree.t_leave + i);
      active |= MaskBits(d, hn::Le(hn::Load(d, subtree.t_enter + i), leave)) << i;
    }
    return active;
  }

  void Confirm(std::uint64_t place, std::size_t lane) {
    if (visitors_[lane].visit(tree_, positions_, place, rays_[lane])) {
      packet_.EndLane(lane);
    } else {
      packet_.LimitLane(lane, visitors_[lane].t_limit());
    }
  }

  // One particle against the rays of `active`.
  HWY_INLINE void VisitParticle(std::uint64_t place, std::uint32_t active) {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    float centre[3];
    positions_.centre_f32(place, centre);
    float radius2 = radius2_;
    if (HWY_UNLIKELY(!uniform_)) {
      const double r = tree_.radius.value(tree_.item(place)) + packet_.margin();
      radius2 = static_cast<float>(r * r * (1.0 + 8.0 * f32_unit));
    }
    const V r2 = hn::Set(d, radius2);
    const V cx = hn::Set(d, centre[0]);
    const V cy = hn::Set(d, centre[1]);
    const V cz = hn::Set(d, centre[2]);
    for (std::size_t i = 0; i < packet_size; i += lanes) {
      const V dx = hn::Load(d, packet_.direction(0) + i);
      const V dy = hn::Load(d, packet_.direction(1) + i);
      const V dz = hn::Load(d, packet_.direction(2) + i);
      const V mx = hn::Sub(cx, hn::Load(d, packet_.origin(0) + i));
      const V my = hn::Sub(cy, hn::Load(d, packet_.origin(1) + i));
      const V mz = hn::Sub(cz, hn::Load(d, packet_.origin(2) + i));
      const auto [b, distance2] = ApproachOf(mx, my, mz, dx, dy, dz);
      const auto close = hn::Le(distance2, r2);
      if (HWY_LIKELY(hn::AllFalse(d, close))) continue;
      const V s = hn::Sqrt(hn::Max(hn::Sub(r2, distance2), hn::Zero(d)));
      const auto in_time = hn::And(hn::Le(hn::Sub(b, s), hn::Load(d, packet_.t_high() + i)),
                                   hn::Ge(hn::Add(b, s), hn::Load(d, packet_.t_low() + i)));
      std::uint32_t candidates = MaskBits(d, hn::And(close, in_time)) << i & active;
      for (; candidates != 0; candidates &= candidates - 1)
        Confirm(place, hwy::Num0BitsBelowLS1Bit_Nonzero32(candidates));
    }
  }

  bool IsExcluded(std::uint64_t item, std::uint32_t active) const {
    for (; active != 0; active &= active - 1)
      if (rays_[hwy::Num0BitsBelowLS1Bit_Nonzero32(active)].exclude == item) return true;
    return false;
  }

  HWY_INLINE void VisitTogether(const PacketSubtree<Key>& run, std::uint32_t active) {
    std::uint64_t end = run.end;
    if (HWY_UNLIKELY(end - run.begin > pkd_leaf_size) && Visitor::one_of_coincident && uniform_ &&
        !IsExcluded(tree_.item(run.begin), active))
      end = run.begin + 1;  // equal spheres: the build puts the one to be shown first
    if (!uniform_ || !packet_.has_beam()) {
      for (std::uint64_t place = run.begin; place < end; ++place) VisitParticle(place, active);
      return;
    }
    float t_leave = 0.0f;
    for (std::uint32_t lanes = active; lanes != 0; lanes &= lanes - 1)
      t_leave = std::max(t_leave, run.t_leave[hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes)]);
    for (std::uint64_t begin = run.begin; begin < end; begin += pkd_leaf_size)
      VisitWithinBeam(begin, static_cast<std::size_t>(std::min(end - begin, pkd_leaf_size)), t_leave, active);
  }

  // SIMD over particles finds those that the beam can touch up to the distance t_leave; they are visited by all rays.
  HWY_INLINE void VisitWithinBeam(std::uint64_t begin, std::size_t count, float t_leave, std::uint32_t active) {
    const hn::CappedTag<float, pkd_leaf_size> d;
    using W = hn::Vec<decltype(d)>;
    const std::size_t lanes = hn::Lanes(d);
    const LeafCentres<Positions> centres(positions_, begin, count);
    const float wide = static_cast<float>((tree_.radius.uniform + packet_.margin()) * (1.0 + 4.0 * f32_unit)) +
                       packet_.beam_radius(t_leave);
    const W wide2 = hn::Set(d, wide * wide);
    const float* o = packet_.beam_origin();
    const float* axis = packet_.beam_direction();
    const W dx = hn::Set(d, axis[0]);
    const W dy = hn::Set(d, axis[1]);
    const W dz = hn::Set(d, axis[2]);
    for (std::size_t done = 0; done < count; done += lanes) {
      const std::size_t first = centres.first_of(d, done);
      W x, y, z;
      centres.load(d, first, x, y, z);
      const W mx = hn::Sub(x, hn::Set(d, o[0]));
      const W my = hn::Sub(y, hn::Set(d, o[1]));
      const W mz = hn::Sub(z, hn::Set(d, o[2]));
      std::uint32_t bits = MaskBits(d, hn::Le(ApproachOf(mx, my, mz, dx, dy, dz).distance2, wide2));
      bits &= ~std::uint32_t{0} >> (32 - std::min(lanes, count - first));
      // What the vector before has seen already.
      if (first < done) bits &= ~std::uint32_t{0} << (done - first);
      for (; bits != 0; bits &= bits - 1)
        VisitParticle(begin + first + hwy::Num0BitsBelowLS1Bit_Nonzero32(bits), active);
    }
  }

  HWY_NOINLINE void VisitOneByOne(const PacketSubtree<Key>& from, std::uint32_t active) {
    for (; active != 0; active &= active - 1) {
      const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(active);
      const RayFrame frame = packet_.FrameOf(lane);
      Subtree<Key, float> start;
      start.begin = from.begin;
      start.end = from.end;
      start.box = from.box;
      start.t_enter = from.t_enter[lane];
      start.t_leave = std::min(from.t_leave[lane], packet_.t_high()[lane]);
      if (start.t_enter > start.t_leave) continue;  // its hit has been found meanwhile
      if (TraverseSubtree(tree_, positions_, TreeFrame(frame), packet_.SlabOf(lane), start, rays_[lane],
                          visitors_[lane])) {
        packet_.EndLane(lane);
      } else {
        packet_.LimitLane(lane, visitors_[lane].t_limit());
      }
    }
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const Ray* rays_;
  RayPacket& packet_;
  Visitor* visitors_;
  bool uniform_;
  float radius2_;
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
