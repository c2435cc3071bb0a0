// Packets of rays through a P-k-d tree: SIMD over rays while many of them go the same way, single rays below that.
// Included once per SIMD target.
#if defined(INSITU_KERNELS_PKD_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PKD_PACKET_INL_H_
#undef INSITU_KERNELS_PKD_PACKET_INL_H_
#else
#define INSITU_KERNELS_PKD_PACKET_INL_H_
#endif

#include "kernels/pkd_single-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

constexpr std::size_t packet_size = 16;

// Fewer rays than this go on one by one, with SIMD over particles.
constexpr int fewest_together = 4;

// Rays in f32, as EnterTree makes them.
class RayPacket {
 public:
  static constexpr std::size_t size = packet_size;

  // Takes rays[0 .. count).
  void Load(const PkdTree& tree, const TreeMargin& margin, const Ray* rays, std::size_t count, const double* t_limits) {
    margin_ = margin.value;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t from = std::min(i, count - 1);
      TreeEntry entry;
      const bool inside = EnterTree(tree, margin_, rays[from], t_limits[from], entry) && i < count;
      t_shift_[i] = inside ? entry.t_shift : 0.0;
      for (int c = 0; c < 3; ++c) {
        origin_[c][i] = inside ? entry.origin[c] : 0.0f;
        direction_[c][i] = static_cast<float>(rays[from].direction[c]);
        inverse_[c][i] = entry.inverse[c];
        widening_[c][i] = entry.widening[c];
      }
      t_low_[i] = inside ? entry.t_low : 0.0f;
      t_enter_[i] = inside ? 0.0f : 1.0f;
      t_high_[i] = inside ? entry.t_high : -1.0f;
    }
  }

  double margin() const { return margin_; }
  const float* origin(int axis) const { return origin_[axis]; }
  const float* direction(int axis) const { return direction_[axis]; }
  const float* inverse(int axis) const { return inverse_[axis]; }
  const float* widening(int axis) const { return widening_[axis]; }
  const float* t_enter() const { return t_enter_; }
  const float* t_low() const { return t_low_; }
  const float* t_high() const { return t_high_; }  // nothing behind it counts: shrinks with every hit

  void LimitLane(std::size_t lane, double t) {
    t_high_[lane] = std::min(t_high_[lane], static_cast<float>(t - t_shift_[lane] + margin_));
  }
  void EndLane(std::size_t lane) { t_high_[lane] = -1e30f; }

  RayFrame FrameOf(std::size_t lane) const {
    RayFrame frame = {};
    for (int c = 0; c < 3; ++c) {
      frame.head[c] = origin_[c][lane];
      frame.point[c] = static_cast<double>(origin_[c][lane]);
      frame.direction[c] = direction_[c][lane];
    }
    frame.scale = 1.0;
    frame.margin = margin_;
    frame.t_shift = t_shift_[lane];
    frame.t_low = t_low_[lane];
    return frame;
  }
  SlabRay<float> SlabOf(std::size_t lane) const {
    SlabRay<float> slab;
    for (int c = 0; c < 3; ++c) {
      slab.origin[c] = origin_[c][lane];
      slab.inverse[c] = inverse_[c][lane];
      slab.widening[c] = widening_[c][lane];
      slab.negative[c] = inverse_[c][lane] < 0.0f;
    }
    return slab;
  }

 private:
  HWY_ALIGN float origin_[3][size];
  HWY_ALIGN float direction_[3][size];
  HWY_ALIGN float inverse_[3][size];
  HWY_ALIGN float widening_[3][size];
  HWY_ALIGN float t_enter_[size];
  HWY_ALIGN float t_low_[size];
  HWY_ALIGN float t_high_[size];
  double t_shift_[size];
  double margin_;
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
    const D d;
    const std::size_t lanes = hn::Lanes(d);
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
        const V at = hn::Set(d, static_cast<float>(plane));
        // The lower side goes into stack[height], the upper one stays in `now`; then the nearer one is taken first.
        PacketSubtree<Key>& lower = stack[height];
        std::uint32_t lower_active = 0;
        std::uint32_t upper_active = 0;
        std::uint32_t negative_lanes = 0;
        for (std::size_t i = 0; i < packet_size; i += lanes) {
          const V inverse = hn::Load(d, packet_.inverse(axis) + i);
          const V at_plane = hn::Mul(hn::Sub(at, hn::Load(d, packet_.origin(axis) + i)), inverse);
          const V widening = hn::Load(d, packet_.widening(axis) + i);
          const V near_leave = hn::Add(at_plane, widening);
          const V far_enter = hn::Sub(at_plane, widening);
          const V enter = hn::Load(d, now.t_enter + i);
          const V leave = hn::Load(d, now.t_leave + i);
          const auto negative = hn::Lt(inverse, hn::Zero(d));
          const V enter_far = hn::Max(enter, far_enter);
          const V leave_near = hn::Min(leave, near_leave);
          const V lower_enter = hn::IfThenElse(negative, enter_far, enter);
          const V lower_leave = hn::IfThenElse(negative, leave, leave_near);
          const V upper_enter = hn::IfThenElse(negative, enter, enter_far);
          const V upper_leave = hn::IfThenElse(negative, leave_near, leave);
          hn::Store(lower_enter, d, lower.t_enter + i);
          hn::Store(lower_leave, d, lower.t_leave + i);
          hn::Store(upper_enter, d, now.t_enter + i);
          hn::Store(upper_leave, d, now.t_leave + i);
          lower_active |= Bits(d, hn::Le(lower_enter, lower_leave)) << i;
          upper_active |= Bits(d, hn::Le(upper_enter, upper_leave)) << i;
          negative_lanes |= Bits(d, negative) << i;
        }
        const std::uint32_t crossing = lower_active & upper_active;
        if (crossing != 0) VisitParticle(mid, crossing);
        lower.begin = now.begin;
        lower.end = mid;
        lower.box = now.box;
        lower.box.upper[axis] = plane;
        now.begin = mid + 1;
        now.box.lower[axis] = plane;
        const bool upper_first = 2 * hwy::PopCount(negative_lanes & active) > hwy::PopCount(active);
        if (lower_active == 0) {
          active = upper_active;
        } else if (upper_active == 0) {
          now = lower;
          active = lower_active;
        } else if (upper_first) {
          ++height;
          active = upper_active;
        } else {
          std::swap(now, lower);
          ++height;
          active = lower_active;
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

  template <class Mask>
  static HWY_INLINE std::uint32_t Bits(D d, Mask mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    std::uint32_t bits;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
  }

  // Takes hits found meanwhile into account.
  HWY_INLINE std::uint32_t ActiveLanes(PacketSubtree<Key>& subtree) const {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    std::uint32_t active = 0;
    for (std::size_t i = 0; i < packet_size; i += lanes) {
      const V leave = hn::Min(hn::Load(d, subtree.t_leave + i), hn::Load(d, packet_.t_high() + i));
      hn::Store(leave, d, subtree.t_leave + i);
      active |= Bits(d, hn::Le(hn::Load(d, subtree.t_enter + i), leave)) << i;
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
      const V b = hn::MulAdd(mx, dx, hn::MulAdd(my, dy, hn::Mul(mz, dz)));
      const V px = hn::NegMulAdd(b, dx, mx);
      const V py = hn::NegMulAdd(b, dy, my);
      const V pz = hn::NegMulAdd(b, dz, mz);
      const V distance2 = hn::MulAdd(px, px, hn::MulAdd(py, py, hn::Mul(pz, pz)));
      const auto close = hn::Le(distance2, r2);
      if (HWY_LIKELY(hn::AllFalse(d, close))) continue;
      const V s = hn::Sqrt(hn::Max(hn::Sub(r2, distance2), hn::Zero(d)));
      const auto in_time = hn::And(hn::Le(hn::Sub(b, s), hn::Load(d, packet_.t_high() + i)),
                                   hn::Ge(hn::Add(b, s), hn::Load(d, packet_.t_low() + i)));
      std::uint32_t candidates = Bits(d, hn::And(close, in_time)) << i & active;
      for (; candidates != 0; candidates &= candidates - 1)
        Confirm(place, hwy::Num0BitsBelowLS1Bit_Nonzero32(candidates));
    }
  }

  HWY_INLINE void VisitTogether(const PacketSubtree<Key>& run, std::uint32_t active) {
    std::uint64_t end = run.end;
    if (HWY_UNLIKELY(end - run.begin > pkd_leaf_size) && Visitor::one_of_coincident && uniform_) end = run.begin + 1;
    for (std::uint64_t place = run.begin; place < end; ++place) VisitParticle(place, active);
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
