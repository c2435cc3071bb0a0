// Selection for the build of a P-k-d tree: puts the particle of the wanted rank in its place along one axis, those that
// are not above it before it and those that are not below it behind it.
//
// Pivots are taken from a sample at a rank a little beyond the wanted one (after Floyd and Rivest, "Expected time
// bounds for selection", CACM 18(3), 1975): two partitions, of n and about n/2 particles, leave a few percent of n. The
// partition has no branch on the data (Lomuto's, always swapping), which is what makes it several times faster than
// std::nth_element on random data.
//
// A Store gives access to the places of a tree under construction:
//   Key key(place, axis)
//   void swap(a, b)
//   place partition(begin, end, axis, pivot, Below): the particles for which Below(key, pivot) holds come first
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace insitu::kernels {

struct Less {
  template <class Key>
  bool operator()(Key key, Key pivot) const {
    return key < pivot;
  }
};
struct NotGreater {
  template <class Key>
  bool operator()(Key key, Key pivot) const {
    return key <= pivot;
  }
};

// Records in memory, each with its three coordinates in a member x[3].
template <class Record>
class RecordStore {
 public:
  using Key = std::remove_all_extents_t<decltype(Record::x)>;

  explicit RecordStore(Record* records) : records_(records) {}

  Key key(std::uint64_t place, int axis) const { return records_[place].x[axis]; }
  void swap(std::uint64_t a, std::uint64_t b) { std::swap(records_[a], records_[b]); }

  template <class Below>
  std::uint64_t partition(std::uint64_t begin, std::uint64_t end, int axis, Key pivot, Below below) {
    std::uint64_t next = begin;
    for (std::uint64_t i = begin; i < end; ++i) {
      const Record record = records_[i];
      records_[i] = records_[next];
      records_[next] = record;
      next += below(record.x[axis], pivot) ? 1 : 0;
    }
    return next;
  }

 private:
  Record* records_;
};

// The pivot for rank `wanted` of n places: from a sorted sample, beyond the wanted rank towards the longer side, so
// that the wanted place is left in the shorter part.
template <class Store>
typename Store::Key sample_pivot(const Store& store, std::uint64_t begin, std::uint64_t end, std::uint64_t wanted,
                                 int axis) {
  constexpr std::uint64_t most = 512;
  typename Store::Key sample[most];
  const std::uint64_t n = end - begin;
  const std::uint64_t size = n >= 20000 ? most : n >= 2000 ? 65 : n >= 200 ? 17 : 5;
  const std::uint64_t step = n / size;
  for (std::uint64_t i = 0; i < size; ++i) sample[i] = store.key(begin + i * step + step / 2, axis);
  const double fraction = static_cast<double>(wanted - begin) / static_cast<double>(n);
  const double spread = std::sqrt(std::max(fraction * (1.0 - fraction), 0.01) / static_cast<double>(size));
  const double rank = fraction < 0.5 ? fraction + 1.2 * spread : fraction - 1.2 * spread;
  const auto at = static_cast<std::uint64_t>(std::clamp(rank, 0.0, 1.0) * static_cast<double>(size - 1) + 0.5);
  std::nth_element(sample, sample + at, sample + size);
  return sample[at];
}

template <class Store>
void sort_few(Store& store, std::uint64_t begin, std::uint64_t end, int axis) {
  for (std::uint64_t i = begin + 1; i < end; ++i)
    for (std::uint64_t j = i; j > begin && store.key(j, axis) < store.key(j - 1, axis); --j) store.swap(j, j - 1);
}

template <class Store>
void select_place(Store& store, std::uint64_t begin, std::uint64_t end, std::uint64_t wanted, int axis) {
  while (end - begin > 12) {
    const auto pivot = sample_pivot(store, begin, end, wanted, axis);
    std::uint64_t split = store.partition(begin, end, axis, pivot, Less{});
    if (wanted < split) {
      end = split;
      continue;
    }
    if (split == begin) {
      // The pivot is the smallest: many equal coordinates, perhaps. They are done with in one pass.
      split = store.partition(begin, end, axis, pivot, NotGreater{});
      if (wanted < split) return;
    }
    begin = split;
  }
  sort_few(store, begin, end, axis);
}

}  // namespace insitu::kernels
