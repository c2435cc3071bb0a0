// Exchanging particles between the two sides of a split plane whose key is known: those that are too large on the left
// with those that are too small on the right. Nothing else moves.
//
// A Store gives access to the places of a tree under construction:
//   std::size_t list(begin, count, axis, relation, pivot, places)   as list_places(), count <= exchange_block
//   void exchange(left, left_places, right, right_places, count)    swaps left + left_places[i] with right + ...[i]
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "kernels/pkd_partition.h"

namespace insitu::kernels {

constexpr std::size_t exchange_block = 256;

struct PlaceRange {
  std::uint64_t begin;
  std::uint64_t end;
};

// Places of a range that are on the wrong side, listed block by block.
template <class Store>
class MisplacedCursor {
 public:
  using Key = typename Store::Key;

  MisplacedCursor(Store& store, PlaceRange range, int axis, Relation relation, Key pivot)
      : store_(store), next_(range.begin), end_(range.end), axis_(axis), relation_(relation), pivot_(pivot) {}

  // Lists the next ones, unless some are left; false at the end of the range.
  bool fill() {
    while (first_ == count_) {
      if (next_ == end_) return false;
      const std::size_t n = static_cast<std::size_t>(std::min<std::uint64_t>(exchange_block, end_ - next_));
      base_ = next_;
      first_ = 0;
      count_ = store_.list(base_, n, axis_, relation_, pivot_, places_);
      next_ += n;
    }
    return true;
  }
  std::size_t listed() const { return count_ - first_; }
  std::uint64_t base() const { return base_; }
  const ListedPlace<Key>* places() const { return places_ + first_; }
  void skip(std::size_t n) { first_ += n; }
  // What has not been dealt with.
  PlaceRange rest() const { return {first_ == count_ ? next_ : base_ + places_[first_], end_}; }

 private:
  Store& store_;
  std::uint64_t next_;
  std::uint64_t end_;
  int axis_;
  Relation relation_;
  Key pivot_;
  std::uint64_t base_ = 0;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  ListedPlace<Key> places_[exchange_block + list_slack];
};

// Until one of the two has no more misplaced particles. Returns how many pairs changed sides.
template <class Store>
std::uint64_t exchange_pairs(Store& store, MisplacedCursor<Store>& left, MisplacedCursor<Store>& right) {
  std::uint64_t pairs = 0;
  while (left.fill() && right.fill()) {
    const std::size_t n = std::min(left.listed(), right.listed());
    store.exchange(left.base(), left.places(), right.base(), right.places(), n);
    left.skip(n);
    right.skip(n);
    pairs += n;
  }
  return pairs;
}

// The places before and behind `mid`, where a particle with the median key already stands: makes every key before it
// at most, every key behind it at least the median. With equal keys one side may run out first: what is left of the
// other then changes places with particles that have the median key. They exist: it is the median.
template <class Store>
std::uint64_t exchange_sides(Store& store, PlaceRange left, PlaceRange right, int axis, typename Store::Key median) {
  using Cursor = MisplacedCursor<Store>;
  Cursor above(store, left, axis, Relation::greater, median);
  Cursor below(store, right, axis, Relation::less, median);
  std::uint64_t pairs = exchange_pairs(store, above, below);
  if (above.fill()) {
    Cursor equal(store, right, axis, Relation::not_greater, median);
    pairs += exchange_pairs(store, above, equal);
  } else if (below.fill()) {
    Cursor equal(store, left, axis, Relation::not_less, median);
    pairs += exchange_pairs(store, equal, below);
  }
  return pairs;
}

}  // namespace insitu::kernels
