// Some particles of a tree as vectors of their centres: runs of places, what a filter leaves of them, a few from here
// and there. Included once per SIMD target.
#if defined(INSITU_KERNELS_PARTICLE_RUNS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PARTICLE_RUNS_INL_H_
#undef INSITU_KERNELS_PARTICLE_RUNS_INL_H_
#else
#define INSITU_KERNELS_PARTICLE_RUNS_INL_H_
#endif

#include "kernels/pkd_leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

// Where an index stands before the coordinates of a run, asking for it (prefetch_run) comes first.
template <class Positions>
HWY_INLINE void PrefetchRunBehind(const Positions& positions, std::uint64_t begin, std::uint64_t end) {
  if constexpr (Positions::is_indirect)
    for (std::uint64_t place = begin; place < end; ++place) positions.prefetch_behind(place);
}

// A vector of coordinates that follow each other, and of records x y z x y z ...; doubles are rounded.
template <class D>
HWY_INLINE hn::Vec<D> LoadColumn(D d, const float* from) {
  return hn::LoadU(d, from);
}
template <class D, class V>
HWY_INLINE void LoadRecords(D d, const float* from, V& x, V& y, V& z) {
  hn::LoadInterleaved3(d, from, x, y, z);
}
#if HWY_TARGET == HWY_SCALAR
template <class D>
HWY_INLINE hn::Vec<D> LoadColumn(D d, const double* from) {
  return hn::Set(d, static_cast<float>(*from));
}
template <class D, class V>
HWY_INLINE void LoadRecords(D d, const double* from, V& x, V& y, V& z) {
  x = LoadColumn(d, from);
  y = LoadColumn(d, from + 1);
  z = LoadColumn(d, from + 2);
}
#else
template <class D>
HWY_INLINE hn::Vec<D> LoadColumn(D d, const double* from) {
  const hn::Half<D> half;
  const hn::Rebind<double, decltype(half)> wide;
  return hn::Combine(d, hn::DemoteTo(half, hn::LoadU(wide, from + hn::Lanes(wide))),
                     hn::DemoteTo(half, hn::LoadU(wide, from)));
}
template <class D, class V>
HWY_INLINE void LoadRecords(D d, const double* from, V& x, V& y, V& z) {
  const hn::Half<D> half;
  const hn::Rebind<double, decltype(half)> wide;
  hn::Vec<decltype(wide)> low[3], high[3];
  hn::LoadInterleaved3(wide, from, low[0], low[1], low[2]);
  hn::LoadInterleaved3(wide, from + 3 * hn::Lanes(wide), high[0], high[1], high[2]);
  x = hn::Combine(d, hn::DemoteTo(half, high[0]), hn::DemoteTo(half, low[0]));
  y = hn::Combine(d, hn::DemoteTo(half, high[1]), hn::DemoteTo(half, low[1]));
  z = hn::Combine(d, hn::DemoteTo(half, high[2]), hn::DemoteTo(half, low[2]));
}
#endif

// Particles that stand at consecutive places (`is_run`).
template <class Positions>
class ParticleRun {
 public:
  static constexpr std::size_t most_lanes = 16;

  HWY_INLINE ParticleRun(const PkdTree& tree, const Positions& positions, std::uint64_t begin, std::uint64_t end)
      : tree_(tree),
        positions_(positions),
        begin_(begin),
        size_(begin < end ? static_cast<std::size_t>(end - begin) : 0) {}

  HWY_INLINE std::size_t size() const { return size_; }
  HWY_INLINE std::uint64_t place(std::size_t i) const { return begin_ + i; }
  static constexpr bool is_run = true;
  // Bit i: particle first + i is drawn; of `count`, at most a vector of them.
  static constexpr bool is_filtered = false;
  HWY_INLINE std::uint32_t Drawn(std::size_t, std::size_t count) const { return ~std::uint32_t{0} >> (32 - count); }

  HWY_INLINE void Centre(std::size_t i, float out[3]) const { positions_.centre_f32(begin_ + i, out); }

  // The centres of particles first .. first + count, at most a vector of them.
  template <class D, class V>
  HWY_INLINE void Load(D d, std::size_t first, std::size_t count, V& x, V& y, V& z) const {
    const std::uint64_t begin = begin_ + first;
    if constexpr (Positions::may_be_packed) {
      // What stands behind the run is read along, as far as there is something, and left alone.
      if (HWY_LIKELY(begin + hn::Lanes(d) <= tree_.position.count)) {
        if (HWY_LIKELY(positions_.packed_records())) return LoadRecords(d, positions_.scalars(begin, 0), x, y, z);
        if (positions_.packed_columns()) {
          x = LoadColumn(d, positions_.scalars(begin, 0));
          y = LoadColumn(d, positions_.scalars(begin, 1));
          z = LoadColumn(d, positions_.scalars(begin, 2));
          return;
        }
      }
    }
    HWY_ALIGN float staged[3][most_lanes] = {};
    for (std::size_t i = 0; i < count; ++i) {
      float centre[3];
      positions_.centre_f32(begin + i, centre);
      for (std::size_t c = 0; c < 3; ++c) staged[c][i] = centre[c];
    }
    x = hn::Load(d, staged[0]);
    y = hn::Load(d, staged[1]);
    z = hn::Load(d, staged[2]);
  }

 protected:
  const PkdTree& tree_;
  const Positions& positions_;
  std::uint64_t begin_;
  std::size_t size_;
};

// The same under a filter.
template <class Positions>
class FilteredRun : public ParticleRun<Positions> {
 public:
  // An inherited constructor would not be compiled for the target.
  HWY_INLINE FilteredRun(const PkdTree& tree, const Positions& positions, std::uint64_t begin, std::uint64_t end)
      : ParticleRun<Positions>(tree, positions, begin, end) {}
  static constexpr bool is_filtered = true;
  HWY_INLINE std::uint32_t Drawn(std::size_t first, std::size_t count) const {
    return static_cast<std::uint32_t>(this->tree_.selected.bits(this->begin_ + first, count));
  }
};

// A few particles from here and there.
class ParticlePick {
 public:
  static constexpr std::size_t most = 16;

  HWY_INLINE std::size_t size() const { return size_; }
  HWY_INLINE std::uint64_t place(std::size_t i) const { return places_[i]; }
  static constexpr bool is_run = false;
  static constexpr bool is_filtered = false;
  HWY_INLINE std::uint32_t Drawn(std::size_t, std::size_t count) const { return ~std::uint32_t{0} >> (32 - count); }
  HWY_INLINE void Centre(std::size_t i, float out[3]) const {
    for (std::size_t c = 0; c < 3; ++c) out[c] = centre_[c][i];
  }
  HWY_INLINE void KeepDrawn(const SelectedPlaces& selected) {
    const std::size_t size = size_;
    size_ = 0;
    for (std::size_t i = 0; i < size; ++i) {
      float centre[3];
      Centre(i, centre);
      if (selected.has(places_[i])) add(places_[i], centre);
    }
  }
  HWY_INLINE void clear() { size_ = 0; }
  HWY_INLINE void add(std::uint64_t place, const float centre[3]) {
    places_[size_] = place;
    for (std::size_t c = 0; c < 3; ++c) centre_[c][size_] = centre[c];
    ++size_;
  }

  template <class D, class V>
  HWY_INLINE void Load(D d, std::size_t first, std::size_t, V& x, V& y, V& z) const {
    x = hn::Load(d, centre_[0] + first);
    y = hn::Load(d, centre_[1] + first);
    z = hn::Load(d, centre_[2] + first);
  }

 private:
  HWY_ALIGN float centre_[3][most] = {};
  std::uint64_t places_[most];
  std::size_t size_ = 0;
};

// Under a filter: what is drawn of a run, by bits.
class DrawnPlaces {
 public:
  HWY_INLINE DrawnPlaces(const PkdTree& tree, std::uint64_t begin, std::uint64_t end)
      : selected_(tree.selected), next_(begin), end_(end) {}

  // Whether a vector of particles here and there, put together, is less to do than the run as it is.
  HWY_INLINE bool AreFew(std::size_t lanes) const {
    if (end_ <= next_ + lanes) return false;
    std::size_t drawn = 0;
    for (std::uint64_t begin = next_; begin < end_; begin += 64) drawn += hwy::PopCount(Word(begin));
    return 4 * drawn <= end_ - next_;
  }
  template <class Action>
  HWY_INLINE void Each(const Action& action) const {
    for (std::uint64_t begin = next_; begin < end_; begin += 64)
      for (std::uint64_t left = Word(begin); left != 0; left &= left - 1)
        action(begin + hwy::Num0BitsBelowLS1Bit_Nonzero64(left));
  }
  // Puts the next ones into `pick`, at most `most`. False: there are no more.
  template <class Positions>
  HWY_INLINE bool Take(const Positions& positions, std::size_t most, ParticlePick& pick) {
    pick.clear();
    while (next_ < end_) {
      std::uint64_t left = Word(next_);
      for (; left != 0 && pick.size() < most; left &= left - 1) {
        const std::uint64_t place = next_ + hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
        float centre[3];
        positions.centre_f32(place, centre);
        pick.add(place, centre);
      }
      if (left != 0) {
        next_ += hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
        return true;
      }
      next_ += 64;
    }
    return pick.size() != 0;
  }

 private:
  HWY_INLINE std::uint64_t Word(std::uint64_t begin) const {
    return selected_.bits(begin, std::min<std::uint64_t>(64, end_ - begin));
  }

  const SelectedPlaces& selected_;
  std::uint64_t next_;
  std::uint64_t end_;
};

// Copies of the centres of what a filter leaves.
class CopiedRun {
 public:
  HWY_INLINE CopiedRun(const SelectedCopies& copies, std::uint64_t begin, std::uint64_t end)
      : copies_(copies), begin_(begin), size_(static_cast<std::size_t>(end - begin)) {}

  HWY_INLINE std::size_t size() const { return size_; }
  HWY_INLINE std::uint64_t place(std::size_t i) const { return copies_.place_of[begin_ + i]; }
  static constexpr bool is_run = false;
  static constexpr bool is_filtered = false;
  HWY_INLINE std::uint32_t Drawn(std::size_t, std::size_t count) const { return ~std::uint32_t{0} >> (32 - count); }
  HWY_INLINE void Centre(std::size_t i, float out[3]) const {
    for (std::size_t c = 0; c < 3; ++c) out[c] = copies_.centres[3 * (begin_ + i) + c];
  }
  template <class D, class V>
  HWY_INLINE void Load(D d, std::size_t first, std::size_t, V& x, V& y, V& z) const {
    hn::LoadInterleaved3(d, copies_.centres + 3 * (begin_ + first), x, y, z);
  }
  HWY_INLINE void Prefetch() const {
    if (size_ == 0) return;
    prefetch_bytes(copies_.centres + 3 * begin_, 3 * size_ * sizeof *copies_.centres);
    prefetch_bytes(copies_.place_of + begin_, size_ * sizeof *copies_.place_of);
  }

 private:
  const SelectedCopies& copies_;
  std::uint64_t begin_;
  std::size_t size_;
};

// What a walk under a filter will read of a leaf, as prefetch_run() and PrefetchRunBehind without one; `copied`: begin
// and end count copies.
template <class Positions>
HWY_NOINLINE void PrefetchDrawn(const PkdTree& tree, const Positions& positions, std::uint64_t begin, std::uint64_t end,
                                bool copied) {
  if (copied) return CopiedRun(tree.copies, begin, end).Prefetch();
  DrawnPlaces(tree, begin, end).Each([&](std::uint64_t place) HWY_ATTR { positions.prefetch(place); });
}
template <class Positions>
HWY_NOINLINE void PrefetchDrawnBehind(const PkdTree& tree, const Positions& positions, std::uint64_t begin,
                                      std::uint64_t end, bool copied) {
  if constexpr (Positions::is_indirect)
    if (!copied)
      DrawnPlaces(tree, begin, end).Each([&](std::uint64_t place) HWY_ATTR { positions.prefetch_behind(place); });
}

// Calls visit(particles) with what a filter has left of a run, whichever way is the shortest: the copies, the run as it
// is, or a vector of particles put together after the other.
template <class Positions, class Visit>
HWY_INLINE void VisitDrawn(const PkdTree& tree, const Positions& positions, std::uint64_t begin, std::uint64_t end,
                           bool copied, const Visit& visit) {
  if (copied) return visit(CopiedRun(tree.copies, begin, end));
  const std::size_t lanes = hn::Lanes(hn::CappedTag<float, ParticlePick::most>());
  DrawnPlaces drawn(tree, begin, end);
  if (!drawn.AreFew(lanes)) return visit(FilteredRun<Positions>(tree, positions, begin, end));
  ParticlePick pick;
  while (drawn.Take(positions, lanes, pick)) visit(pick);
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
