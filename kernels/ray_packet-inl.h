// Streams of coherent rays, in packets with beams around them (ray_beam-inl.h): SIMD over the children of a node for a
// beam, and over its rays for the leaves that it meets; in leaves likewise for particles. Included once per SIMD
// target.
#if defined(INSITU_KERNELS_RAY_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_RAY_PACKET_INL_H_
#undef INSITU_KERNELS_RAY_PACKET_INL_H_
#else
#define INSITU_KERNELS_RAY_PACKET_INL_H_
#endif

#include "kernels/packet_hits-inl.h"
#include "kernels/particle_tests-inl.h"
#include "kernels/pkd_single-inl.h"
#include "kernels/ray_beam-inl.h"
#include "kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

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
        tests_(tree, margin),
        found_(tree, positions, margin),
        packets_(new RayPacket[(most_rays + size - 1) / size]),
        beams_(new RayBeam[most_octants * ((most_rays + size - 1) / size)]) {}

  // Packets of rays[0 .. count). A beam of octant o is put down by add(o, beam).
  template <class AddBeam>
  void Enter(const Ray* rays, Hit* hits, std::size_t count, const AddBeam& add) {
    found_.Begin(rays, hits);
    std::uint32_t beams = 0;
    packet_count_ = 0;
    for (std::size_t first = 0; first < count; first += size) {
      // The rays of the packet after the next.
      prefetch_bytes(rays + std::min(first + 2 * size, count), size * sizeof(Ray));
      RayPacket& packet = packets_[packet_count_];
      const std::size_t in_packet = std::min(size, count - first);
      packet.rays.Load(rays + first, in_packet);
      if (HWY_UNLIKELY(!packet.rays.StartWithin(margin_.farthest))) {
        TraceOneByOne(rays + first, hits + first, in_packet);
        continue;
      }
      found_.Enter(packet, first, in_packet);
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
        packet.UpdateLatest(beam);
        add(octant, beams++);
      }
      ++packet_count_;
    }
  }

  // After the walk.
  void Finish() {
    for (std::size_t i = 0; i < packet_count_; ++i)
      if (packets_[i].noted != 0) found_.ConfirmAllNoted(packets_[i]);
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
              HWY_ATTR { changed |= found_.VisitParticle(packet, place, centre, radius, beam.active); },
          [&]() HWY_ATTR {
            if (changed) packet.UpdateLatest(beam);
            changed = false;
          });
    }
  }

  // Rays that come from too far away.
  HWY_NOINLINE void TraceOneByOne(const Ray* rays, Hit* hits, std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i) {
      FirstHitVisitor visitor(rays[i], hits[i], is_own_hit(tree_, hits[i]));
      TraverseTree(tree_, positions_, rays[i], visitor);
    }
  }

  const PkdTree& tree_;
  const Positions& positions_;
  const TreeMargin& margin_;
  const bool copied_;  // the leaves of the walk are runs of copies
  const ParticleTests tests_;
  PacketHits<Positions> found_;
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
