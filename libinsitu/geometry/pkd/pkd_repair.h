// Mending the order of particles that are nearly in tree order: a simulation moves little between two steps, and what
// was a tree then needs a few exchanges to be one again.
//
// The bounds of short runs of places tell which runs a split plane can concern: at a node only those near its plane are
// read, everything else is known to be on its side. Bounds grow by what is exchanged, so they hold all the way down.
// The median is searched near the old one, and is exact as always: the result obeys the same rules as a build from
// scratch.
#pragma once

#include <vector>

#include "geometry/pkd/pkd_split.h"

namespace insitu {

// Bounds of the particles at consecutive places, at most most_runs of them.
constexpr std::uint64_t most_runs = std::uint64_t{1} << 16;
constexpr std::uint64_t shortest_run = 256;

template <class Store>
class RunBounds {
 public:
  using Key = typename Store::Key;
  using Box = kernels::PkdBox<Key>;

  RunBounds(const Store& store, std::uint64_t count)
      : length_(std::max(shortest_run, (count + most_runs - 1) / most_runs)),
        boxes_(static_cast<std::size_t>((count + length_ - 1) / length_)) {
    constexpr std::size_t together = 16;
    for_chunks((boxes_.size() + together - 1) / together, [&](std::uint64_t chunk) {
      const std::size_t first = static_cast<std::size_t>(chunk) * together;
      for (std::size_t run = first; run < std::min(first + together, boxes_.size()); ++run)
        boxes_[run] = bounds_of(store, run * length_, std::min(count, (run + 1) * length_));
    });
  }

  // The runs that lie within a range as a whole; [begin, end) of their numbers, empty when there is none.
  kernels::PlaceRange within(kernels::PlaceRange range) const {
    const std::uint64_t begin = (range.begin + length_ - 1) / length_;
    return {begin, std::max(begin, range.end / length_)};
  }
  std::uint64_t length() const { return length_; }
  const Box& box(std::uint64_t run) const { return boxes_[static_cast<std::size_t>(run)]; }

  // The particle now at `place` belongs to its run. Runs that reach beyond `within` are shared with other threads, and
  // never asked for again.
  void add(const Store& store, std::uint64_t place, kernels::PlaceRange within) {
    const std::uint64_t run = place / length_;
    if (run < within.begin || run >= within.end) return;
    Box& box = boxes_[static_cast<std::size_t>(run)];
    for (int axis = 0; axis < 3; ++axis) {
      const Key key = store.key(place, axis);
      box.lower[axis] = std::min(box.lower[axis], key);
      box.upper[axis] = std::max(box.upper[axis], key);
    }
  }

 private:
  static Box bounds_of(const Store& store, std::uint64_t begin, std::uint64_t end) {
    Box box;
    Key buffer[shortest_run + kernels::run_padding];
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = std::numeric_limits<Key>::infinity();
      box.upper[axis] = -box.lower[axis];
    }
    for (std::uint64_t at = begin; at < end; at += shortest_run) {
      const auto n = static_cast<std::size_t>(std::min(shortest_run, end - at));
      for (int axis = 0; axis < 3; ++axis) {
        const KeyRun<Key> run = store.keys(at, n, axis, buffer);
        if (axis == 0 && run.components == 3) {
          // Finite: they are drawn.
          Key lower[3];
          Key upper[3];
          kernels::bounds_of_records(run.first, n, lower, upper);
          for (int c = 0; c < 3; ++c) {
            box.lower[c] = std::min(box.lower[c], lower[c]);
            box.upper[c] = std::max(box.upper[c], upper[c]);
          }
          break;
        }
        for (std::size_t i = 0; i < n; ++i) {
          const Key key = run.first[i * static_cast<std::size_t>(run.components)];
          box.lower[axis] = std::min(box.lower[axis], key);
          box.upper[axis] = std::max(box.upper[axis], key);
        }
      }
    }
    return box;
  }

  std::uint64_t length_;
  std::vector<Box> boxes_;
};

// A Store that tells the bounds of the runs what moves, and counts it.
template <class Store>
class WatchedStore {
 public:
  using Key = typename Store::Key;
  using Place = ListedPlace<Key>;

  WatchedStore(Store& store, RunBounds<Store>& bounds, kernels::PlaceRange range)
      : store_(store), bounds_(bounds), runs_(bounds.within(range)) {}

  KeyRun<Key> keys(std::uint64_t begin, std::size_t count, int axis, Key* buffer) const {
    return store_.keys(begin, count, axis, buffer);
  }
  Key key(std::uint64_t place, int axis) const { return store_.key(place, axis); }
  std::size_t list(std::uint64_t begin, std::size_t count, int axis, kernels::Relation relation, Key pivot,
                   Place* places) const {
    return store_.list(begin, count, axis, relation, pivot, places);
  }
  void exchange(std::uint64_t left, const Place* left_places, std::uint64_t right, const Place* right_places,
                std::size_t count) {
    store_.exchange(left, left_places, right, right_places, count);
    for (std::size_t i = 0; i < count; ++i) {
      bounds_.add(store_, left + left_places[i], runs_);
      bounds_.add(store_, right + right_places[i], runs_);
    }
    moved_ += 2 * count;
  }
  void swap(std::uint64_t a, std::uint64_t b) {
    if (a == b) return;
    store_.swap(a, b);
    bounds_.add(store_, a, runs_);
    bounds_.add(store_, b, runs_);
    moved_ += 2;
  }
  std::uint64_t moved() const { return moved_; }

 private:
  Store& store_;
  RunBounds<Store>& bounds_;
  kernels::PlaceRange runs_;
  std::uint64_t moved_ = 0;
};

template <class Store>
class NodeRepair {
 public:
  using Key = typename Store::Key;

  NodeRepair(Store& store, RunBounds<Store>& bounds, kernels::PlaceRange range, int axis)
      : store_(store, bounds, range), bounds_(bounds), range_(range), runs_(bounds.within(range)), axis_(axis) {}

  // As split_range(). False, and nothing has moved, when so much would have to be read that building is quicker.
  bool split(std::uint64_t mid, Key extent, Key& median) {
    constexpr Key first_width = Key{1} / 512;  // of the extent, to both sides of the old median
    const Key old = store_.key(mid, axis_);
    std::vector<Key> keys;
    std::vector<std::uint64_t> places;
    for (Key width = first_width * extent;; width *= 8) {
      if (!(width < extent)) return false;
      const Key low = old - width;
      const Key high = old + width;
      std::uint64_t below = 0;
      if (!list_near(low, high, keys, places, below)) return false;
      const std::uint64_t rank = mid - range_.begin;
      if (rank < below || rank >= below + keys.size()) continue;
      const std::size_t count = keys.size();
      std::vector<ListedPlace<Key>> numbers(count + kernels::list_slack);
      for (std::size_t i = 0; i < count; ++i) numbers[i] = static_cast<ListedPlace<Key>>(i);
      keys.resize(count + kernels::list_slack);
      const auto found =
          kernels::select_listed(keys.data(), numbers.data(), count, static_cast<std::size_t>(rank - below));
      median = found.key;
      store_.swap(mid, places[static_cast<std::size_t>(found.place)]);
      break;
    }
    const kernels::PlaceRange left = {range_.begin, mid};
    const kernels::PlaceRange right = {mid + 1, range_.end};
    std::vector<kernels::PlaceRange> above =
        ranges_where(left, [&](const auto& box) { return box.upper[axis_] > median; });
    std::vector<kernels::PlaceRange> below =
        ranges_where(right, [&](const auto& box) { return box.lower[axis_] < median; });
    exchange_rest(store_, above, below, left, right, axis_, median);
    return true;
  }
  std::uint64_t moved() const { return store_.moved(); }

 private:
  // Parts of a range whose runs satisfy a condition, and its ends, of whose runs nothing is known.
  template <class Condition>
  std::vector<kernels::PlaceRange> ranges_where(kernels::PlaceRange range, const Condition& condition) const {
    std::vector<kernels::PlaceRange> ranges;
    const auto append = [&ranges](std::uint64_t begin, std::uint64_t end) {
      if (begin >= end) return;
      if (!ranges.empty() && ranges.back().end == begin) {
        ranges.back().end = end;
      } else {
        ranges.push_back({begin, end});
      }
    };
    // A run across the median is a run of the node, but not of one side: its part is read.
    std::uint64_t run = std::max(range.begin / bounds_.length(), std::uint64_t{0});
    for (std::uint64_t at = range.begin; at < range.end; ++run) {
      const std::uint64_t end = std::min(range.end, (run + 1) * bounds_.length());
      const bool known = run >= runs_.begin && run < runs_.end;
      if (!known || condition(bounds_.box(run))) append(at, end);
      at = end;
    }
    return ranges;
  }

  bool list_near(Key low, Key high, std::vector<Key>& keys, std::vector<std::uint64_t>& places,
                 std::uint64_t& below) const {
    keys.clear();
    places.clear();
    std::uint64_t near = 0;
    const std::vector<kernels::PlaceRange> ranges = ranges_where(range_, [&](const auto& box) {
      const bool is_below = box.upper[axis_] < low;
      below += is_below ? bounds_.length() : 0;
      return !is_below && !(box.lower[axis_] > high);
    });
    for (const kernels::PlaceRange& range : ranges) near += range.end - range.begin;
    // A tree in order has this much near a plane when it is small, less when it is large.
    if (near > (range_.end - range_.begin) / 2) return false;
    Key buffer[most_keys + kernels::run_padding];
    Key listed[most_keys + kernels::list_slack];
    ListedPlace<Key> offsets[most_keys + kernels::list_slack];
    for (const kernels::PlaceRange& range : ranges) {
      for (std::uint64_t begin = range.begin; begin < range.end; begin += most_keys) {
        const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(most_keys, range.end - begin));
        const kernels::BandCount count =
            kernels::list_band(store_.keys(begin, n, axis_, buffer), n, low, high, 0, listed, offsets);
        below += count.below;
        if (keys.size() + count.inside > most_chunks * listed_per_chunk) return false;
        for (std::size_t i = 0; i < count.inside; ++i) {
          keys.push_back(listed[i]);
          places.push_back(begin + offsets[i]);
        }
      }
    }
    return true;
  }

  WatchedStore<Store> store_;
  const RunBounds<Store>& bounds_;
  kernels::PlaceRange range_;
  kernels::PlaceRange runs_;
  int axis_;
};

}  // namespace insitu
