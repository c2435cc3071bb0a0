// The paper's traversal: front to back, with split planes moved outwards by the radius, and each node's own particle
// tested where the ray crosses its widened plane. Included once per SIMD target.
#if defined(INSITU_BENCH_PAPER_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_BENCH_PAPER_WALK_INL_H_
#undef INSITU_BENCH_PAPER_WALK_INL_H_
#else
#define INSITU_BENCH_PAPER_WALK_INL_H_
#endif

#include "paper_packet-inl.h"
#include "paper_tree.h"

HWY_BEFORE_NAMESPACE();
namespace bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace in = insitu::kernels::HWY_NAMESPACE;
using insitu::kernels::PkdTree;
using insitu::kernels::Ray;
using insitu::kernels::TreeMargin;
using Positions = insitu::kernels::PlacedPositions<float>;

// How a node is found. Exists() is asked of every child before it is entered.
struct HeapOrder {
  using Node = std::uint64_t;
  std::uint64_t count;
  Node Root() const { return 0; }
  bool Exists(Node node) const { return node < count; }
  bool IsLeaf(Node node) const { return 2 * node + 1 >= count; }
  std::uint64_t Place(Node node) const { return node; }
  Node Child(Node node, bool upper) const { return 2 * node + (upper ? 2 : 1); }
};

struct InOrder {
  struct Node {
    std::uint64_t begin;
    std::uint64_t end;
  };
  std::uint64_t count;
  Node Root() const { return {0, count}; }
  bool Exists(Node node) const { return node.begin < node.end; }
  bool IsLeaf(Node node) const { return node.end - node.begin == 1; }
  std::uint64_t Place(Node node) const { return node.begin + (node.end - node.begin) / 2; }
  Node Child(Node node, bool upper) const {
    const std::uint64_t mid = Place(node);
    return upper ? Node{mid + 1, node.end} : Node{node.begin, mid};
  }
};

template <class Order>
struct PaperNode {
  typename Order::Node node;
  int cyclic_axis;  // the depth of the node modulo 3
};

template <class Order, AxisRule rule>
class PaperNodes {
 public:
  using Node = PaperNode<Order>;

  PaperNodes(const PkdTree& tree, const std::uint8_t* axes) : order_{tree.count}, axes_(axes) {}

  Node Root() const { return {order_.Root(), 0}; }
  bool Exists(const Node& node) const { return order_.Exists(node.node); }
  bool IsLeaf(const Node& node) const { return order_.IsLeaf(node.node); }
  std::uint64_t Place(const Node& node) const { return order_.Place(node.node); }
  int Axis(const Node& node, std::uint64_t place) const {
    return rule == AxisRule::round_robin ? node.cyclic_axis : axes_[place];
  }
  Node Child(const Node& node, bool upper) const {
    return {order_.Child(node.node, upper), node.cyclic_axis == 2 ? 0 : node.cyclic_axis + 1};
  }
  // What the children will read: in the heap both stand side by side.
  void PrefetchChildren(const Positions& positions, const Node& node) const {
    const Node lower = Child(node, false);
    const Node upper = Child(node, true);
    if (Exists(lower)) positions.prefetch(Place(lower));
    if (Exists(upper)) positions.prefetch(Place(upper));
  }

 private:
  const Order order_;
  const std::uint8_t* axes_;
};

// A ray in scalars, with a widened sphere test of its own. Real is float where the frame of the tree fits the ray (see
// TreeMargin); in double, for the others, every particle that is reached is left to the confirmation.
template <class Real>
struct PaperRay {
  Real origin[3];
  Real direction[3];
  Real inverse[3];
  Real widening[3];
  Real t_low;
  Real t_high;
  double t_shift;

  void Limit(double t, double margin) { t_high = std::min(t_high, static_cast<Real>(t - t_shift + margin)); }
};

template <class Nodes, class Real, class Visitor>
class SingleWalk {
 public:
  using Node = typename Nodes::Node;

  SingleWalk(const PkdTree& tree, const Positions& positions, const Nodes& nodes, double margin, const Ray& exact,
             PaperRay<Real>& ray, Visitor& visitor)
      : tree_(tree),
        positions_(positions),
        nodes_(nodes),
        margin_(margin),
        exact_(exact),
        ray_(ray),
        visitor_(visitor) {
    const double wide = tree.radius.uniform + margin;
    radius2_ = static_cast<Real>(wide * wide * (1.0 + 8.0 * insitu::kernels::f32_unit));
  }

  HWY_INLINE void Run(Real t_enter, Real t_leave) {
    struct Far {
      Node node;
      Real t_enter;
      Real t_leave;
    };
    Far stack[64];
    int height = 0;
    Node now = nodes_.Root();
    for (;;) {
      while (nodes_.Exists(now)) {
        const std::uint64_t place = nodes_.Place(now);
        if (nodes_.IsLeaf(now)) {
          if (Visit(place)) return;
          break;
        }
        nodes_.PrefetchChildren(positions_, now);
        const int axis = nodes_.Axis(now, place);
        const Real inverse = ray_.inverse[axis];
        const Real at_plane = (static_cast<Real>(positions_.key(place, axis)) - ray_.origin[axis]) * inverse;
        const Real near_leave = at_plane + ray_.widening[axis];
        const Real far_enter = at_plane - ray_.widening[axis];
        const bool go_near = t_enter <= near_leave;
        const bool go_far = far_enter <= t_leave;
        const bool near_is_upper = inverse < Real{0};
        bool go_upper = go_near == near_is_upper;  // when only one side is entered
        if (go_near && go_far) {
          if (Visit(place)) return;
          const Node far = nodes_.Child(now, !near_is_upper);
          if (nodes_.Exists(far)) stack[height++] = {far, std::max(t_enter, far_enter), t_leave};
          t_leave = std::min(t_leave, near_leave);
          go_upper = near_is_upper;
        }
        now = nodes_.Child(now, go_upper);
      }
      do {
        if (height == 0) return;
        const Far& far = stack[--height];
        now = far.node;
        t_enter = far.t_enter;
        t_leave = std::min(far.t_leave, ray_.t_high);
      } while (t_enter > t_leave);
    }
  }

 private:
  // True: the ray needs no more.
  HWY_INLINE bool Visit(std::uint64_t place) {
    if constexpr (sizeof(Real) == sizeof(float)) {
      const Real mx = positions_.key(place, 0) - ray_.origin[0];
      const Real my = positions_.key(place, 1) - ray_.origin[1];
      const Real mz = positions_.key(place, 2) - ray_.origin[2];
      const Real b = mx * ray_.direction[0] + my * ray_.direction[1] + mz * ray_.direction[2];
      const Real px = mx - b * ray_.direction[0];
      const Real py = my - b * ray_.direction[1];
      const Real pz = mz - b * ray_.direction[2];
      const Real distance2 = px * px + py * py + pz * pz;
      if (distance2 > radius2_) return false;
      const Real s = std::sqrt(std::max(radius2_ - distance2, Real{0}));
      if (b - s > ray_.t_high || b + s < ray_.t_low) return false;
    }
    if (visitor_.visit(tree_, positions_, place, exact_)) return true;
    ray_.Limit(visitor_.t_limit(), margin_);
    return false;
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const Nodes& nodes_;
  const double margin_;
  const Ray& exact_;
  PaperRay<Real>& ray_;
  Visitor& visitor_;
  Real radius2_;
};

// 16 rays that share one stack: a node is visited while any lane is active in it. Near and far are those of most lanes.
template <class Nodes, class Visitor>
class PacketWalk {
 public:
  static constexpr std::size_t size = in::packet_size;
  using Node = typename Nodes::Node;

  PacketWalk(const PkdTree& tree, const Positions& positions, const Nodes& nodes, const Ray* rays,
             in::PaperPacket& packet, Visitor* visitors)
      : tree_(tree), positions_(positions), nodes_(nodes), rays_(rays), packet_(packet), visitors_(visitors) {
    const double wide = tree.radius.uniform + packet.margin();
    radius2_ = static_cast<float>(wide * wide * (1.0 + 8.0 * insitu::kernels::f32_unit));
  }

  HWY_INLINE void Run() {
    Subtree stack[64];
    Subtree now;
    now.node = nodes_.Root();
    std::fill(std::begin(now.t_enter), std::end(now.t_enter), 0.0f);  // distances count from the nearest entry
    std::memcpy(now.t_leave, packet_.t_high(), sizeof now.t_leave);
    std::uint32_t active = ActiveLanes(now);
    int height = 0;
    for (;;) {
      while (active != 0) {
        const std::uint64_t place = nodes_.Place(now.node);
        if (nodes_.IsLeaf(now.node)) {
          Visit(place, active);
          break;
        }
        nodes_.PrefetchChildren(positions_, now.node);
        const int axis = nodes_.Axis(now.node, place);
        Subtree& far = stack[height];
        std::uint32_t far_active = 0;
        std::uint32_t near_active = Split(now, far, axis, positions_.key(place, axis), far_active);
        if ((near_active & far_active) != 0) Visit(place, near_active & far_active);
        const bool near_is_upper = packet_.negative(axis);
        far.node = nodes_.Child(now.node, !near_is_upper);
        now.node = nodes_.Child(now.node, near_is_upper);
        if (!nodes_.Exists(far.node)) far_active = 0;
        if (!nodes_.Exists(now.node)) near_active = 0;
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
  using D = hn::CappedTag<float, size>;
  using V = hn::Vec<D>;

  struct Subtree {
    HWY_ALIGN float t_enter[size];
    HWY_ALIGN float t_leave[size];
    Node node;
  };

  // `now` becomes the near side. Returns the lanes that enter it.
  HWY_INLINE std::uint32_t Split(Subtree& now, Subtree& far, int axis, float plane, std::uint32_t& far_active) const {
    const D d;
    const V at = hn::Set(d, plane);
    std::uint32_t near_active = 0;
    for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
      const V inverse = hn::Load(d, packet_.inverse(axis) + i);
      const V at_plane = hn::Mul(hn::Sub(at, hn::Load(d, packet_.origin(axis) + i)), inverse);
      const V widening = hn::Load(d, packet_.widening(axis) + i);
      const V enter = hn::Load(d, now.t_enter + i);
      const V leave = hn::Load(d, now.t_leave + i);
      const V first_leave = hn::Min(leave, hn::Add(at_plane, widening));
      const V second_enter = hn::Max(enter, hn::Sub(at_plane, widening));
      V near_enter = enter;
      V near_leave = first_leave;
      V far_enter = second_enter;
      V far_leave = leave;
      if (!packet_.uniform_sign(axis)) {
        const auto is_negative = hn::Lt(inverse, hn::Zero(d));
        const auto other = packet_.negative(axis) ? hn::Not(is_negative) : is_negative;
        near_enter = hn::IfThenElse(other, second_enter, enter);
        near_leave = hn::IfThenElse(other, leave, first_leave);
        far_enter = hn::IfThenElse(other, enter, second_enter);
        far_leave = hn::IfThenElse(other, first_leave, leave);
      }
      hn::Store(near_enter, d, now.t_enter + i);
      hn::Store(near_leave, d, now.t_leave + i);
      hn::Store(far_enter, d, far.t_enter + i);
      hn::Store(far_leave, d, far.t_leave + i);
      near_active |= in::MaskBits(d, hn::Le(near_enter, near_leave)) << i;
      far_active |= in::MaskBits(d, hn::Le(far_enter, far_leave)) << i;
    }
    return near_active;
  }

  // Takes hits found meanwhile into account.
  HWY_INLINE std::uint32_t ActiveLanes(Subtree& subtree) const {
    const D d;
    std::uint32_t active = 0;
    for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
      const V leave = hn::Min(hn::Load(d, subtree.t_leave + i), hn::Load(d, packet_.t_high() + i));
      hn::Store(leave, d, subtree.t_leave + i);
      active |= in::MaskBits(d, hn::Le(hn::Load(d, subtree.t_enter + i), leave)) << i;
    }
    return active;
  }

  HWY_INLINE void Visit(std::uint64_t place, std::uint32_t active) {
    const D d;
    const V r2 = hn::Set(d, radius2_);
    const V cx = hn::Set(d, positions_.key(place, 0));
    const V cy = hn::Set(d, positions_.key(place, 1));
    const V cz = hn::Set(d, positions_.key(place, 2));
    for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
      const auto [b, distance2] = in::ApproachOf(
          hn::Sub(cx, hn::Load(d, packet_.origin(0) + i)), hn::Sub(cy, hn::Load(d, packet_.origin(1) + i)),
          hn::Sub(cz, hn::Load(d, packet_.origin(2) + i)), hn::Load(d, packet_.direction(0) + i),
          hn::Load(d, packet_.direction(1) + i), hn::Load(d, packet_.direction(2) + i));
      const auto close = hn::Le(distance2, r2);
      if (hn::AllFalse(d, close)) continue;
      const V s = hn::Sqrt(hn::Max(hn::Sub(r2, distance2), hn::Zero(d)));
      const auto in_time = hn::And(hn::Le(hn::Sub(b, s), hn::Load(d, packet_.t_high() + i)),
                                   hn::Ge(hn::Add(b, s), hn::Load(d, packet_.t_low() + i)));
      std::uint32_t candidates = in::MaskBits(d, hn::And(close, in_time)) << i & active;
      for (; candidates != 0; candidates &= candidates - 1) {
        const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(candidates);
        if (visitors_[lane].visit(tree_, positions_, place, rays_[lane])) {
          packet_.EndLane(lane);
        } else {
          packet_.LimitLane(lane, visitors_[lane].t_limit());
        }
      }
    }
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const Nodes& nodes_;
  const Ray* rays_;
  in::PaperPacket& packet_;
  Visitor* visitors_;
  float radius2_;
};

}  // namespace bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
