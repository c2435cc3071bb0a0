// Splitting a large range of places at its median, with several threads: the median is found by reading, and only
// particles on the wrong side of it move. What is moved where does not depend on the number of threads.
#pragma once

#include <oneapi/tbb/parallel_for.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "core/float_environment.h"
#include "geometry/pkd/pkd_store.h"

namespace insitu {

// Keys near the median that are listed while the range is read: at most this many chunks of this many.
constexpr std::uint64_t most_chunks = 64;
constexpr std::size_t listed_per_chunk = 4096;
constexpr std::uint64_t least_chunk = std::uint64_t{1} << 16;  // places

inline std::uint64_t chunks_of(std::uint64_t count) {
  return std::min(most_chunks, (count + least_chunk - 1) / least_chunk);
}
inline kernels::PlaceRange chunk_of(kernels::PlaceRange all, std::uint64_t chunk, std::uint64_t chunks) {
  const std::uint64_t count = all.end - all.begin;
  const std::uint64_t length = count / chunks;
  const std::uint64_t longer = count % chunks;
  const std::uint64_t begin = all.begin + chunk * length + std::min(chunk, longer);
  return {begin, begin + length + (chunk < longer ? 1 : 0)};
}

template <class Work>
void for_chunks(std::uint64_t chunks, const Work& work) {
  if (chunks == 1) return work(std::uint64_t{0});
  tbb::parallel_for(std::uint64_t{0}, chunks, [&work](std::uint64_t chunk) {
    const FloatEnvironment guard;
    work(chunk);
  });
}

template <class Store>
class MedianSearch {
 public:
  using Key = typename Store::Key;
  struct Found {
    Key key;
    std::uint64_t place;
  };

  MedianSearch(const Store& store, kernels::PlaceRange range, std::uint64_t wanted, int axis)
      : store_(store),
        range_(range),
        rank_(wanted - range.begin),
        axis_(axis),
        chunks_(chunks_of(range.end - range.begin)) {}

  Found find() {
    std::vector<Key> sample = sample_keys();
    // Bounds of the median as far as known, and its rank among the keys within them.
    Key low = -infinity;
    Key high = infinity;
    double fraction = static_cast<double>(rank_) / static_cast<double>(range_.end - range_.begin);
    for (bool single = false;;) {
      const auto [first, last] = band_of(sample, low, high, fraction, single);
      read(first, last);
      if (rank_ < below_) {
        fraction = static_cast<double>(rank_) / static_cast<double>(below_);
        high = std::nextafter(first, -infinity);
      } else if (rank_ >= below_ + inside_) {
        fraction = static_cast<double>(rank_ - below_ - inside_) /
                   static_cast<double>(range_.end - range_.begin - below_ - inside_);
        low = std::nextafter(last, infinity);
      } else {
        const std::vector<Listed> listed = take_lists();
        if (listed.size() == inside_) return select(listed, rank_ - below_);
        if (first == last) return {first, listed.front().place};
        // Too many to be listed: those that are make a better sample. Without progress a single key is asked for.
        fraction = static_cast<double>(rank_ - below_) / static_cast<double>(inside_);
        single = low == first && high == last;
        low = first;
        high = last;
        sample.clear();
        for (const Listed& one : listed) sample.push_back(one.key);
        continue;
      }
      // Keys known to be out of bounds tell nothing more. None left: the next reading brings new ones.
      std::erase_if(sample, [low, high](Key key) { return !(key >= low && key <= high); });
      single = false;
    }
  }

 private:
  static constexpr Key infinity = std::numeric_limits<Key>::infinity();
  struct Listed {
    Key key;
    std::uint64_t place;
  };
  // Lists every stride-th key of the band; when it is full it drops every second: whatever the order of the particles,
  // what is listed is a fair sample.
  struct Chunk {
    std::uint64_t below = 0;
    std::uint64_t inside = 0;
    std::uint64_t stride = 1;
    std::vector<Listed> listed;

    void list(Key key, std::uint64_t place) {
      if (inside++ % stride != 0) return;
      if (listed.size() == listed_per_chunk) {
        for (std::size_t i = 0; 2 * i < listed.size(); ++i) listed[i] = listed[2 * i];
        listed.resize(listed_per_chunk / 2);
        stride *= 2;
        if ((inside - 1) % stride != 0) return;
      }
      listed.push_back({key, place});
    }
  };

  std::vector<Key> sample_keys() const {
    const std::uint64_t count = range_.end - range_.begin;
    const std::uint64_t size = std::min(std::clamp<std::uint64_t>(count / 128, 512, 16384), 1 + count / 8);
    const std::uint64_t step = count / size;
    std::vector<Key> sample(size);
    // Anywhere within each step: the order of the particles may have a period of its own.
    for (std::uint64_t i = 0; i < size; ++i) {
      const std::uint64_t within = (i * 0x9e3779b97f4a7c15 >> 32) % step;
      sample[i] = store_.key(range_.begin + i * count / size + within, axis_);
    }
    return sample;
  }

  static Key ranked(const std::vector<Key>& sample, std::size_t rank) {
    std::vector<Key> keys(sample.size() + kernels::list_slack);
    std::vector<ListedPlace<Key>> places(keys.size());
    std::copy(sample.begin(), sample.end(), keys.begin());
    return kernels::select_listed(keys.data(), places.data(), sample.size(), rank).key;
  }

  std::pair<Key, Key> band_of(const std::vector<Key>& sample, Key low, Key high, double fraction, bool single) const {
    const std::size_t size = sample.size();
    if (size < 16) return {low, high};
    const auto at = static_cast<std::size_t>(fraction * static_cast<double>(size - 1));
    if (single) {
      const Key key = ranked(sample, at);
      return {key, key};
    }
    const auto margin = static_cast<std::size_t>(std::sqrt(static_cast<double>(size)));
    return {at > margin ? ranked(sample, at - margin) : low, at + margin < size ? ranked(sample, at + margin) : high};
  }

  void read(Key first, Key last) {
    lists_.assign(chunks_, Chunk());
    for_chunks(chunks_, [&](std::uint64_t number) {
      Chunk& chunk = lists_[number];
      Key buffer[most_keys + kernels::run_padding];
      Key keys[most_keys + kernels::list_slack];
      ListedPlace<Key> offsets[most_keys + kernels::list_slack];
      // Every chunks_-th run: the band of particles that are in order stands together, and is to fill all lists alike.
      for (std::uint64_t begin = range_.begin + number * most_keys; begin < range_.end; begin += chunks_ * most_keys) {
        const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(most_keys, range_.end - begin));
        const kernels::BandCount count =
            kernels::list_band(store_.keys(begin, n, axis_, buffer), n, first, last, 0, keys, offsets);
        chunk.below += count.below;
        for (std::size_t i = 0; i < count.inside; ++i) chunk.list(keys[i], begin + offsets[i]);
      }
    });
    below_ = 0;
    inside_ = 0;
    for (const Chunk& chunk : lists_) {
      below_ += chunk.below;
      inside_ += chunk.inside;
    }
  }

  std::vector<Listed> take_lists() const {
    std::vector<Listed> all;
    for (const Chunk& chunk : lists_) all.insert(all.end(), chunk.listed.begin(), chunk.listed.end());
    return all;
  }

  static Found select(const std::vector<Listed>& listed, std::uint64_t rank) {
    const std::size_t size = listed.size();
    std::vector<Key> keys(size + kernels::list_slack);
    std::vector<ListedPlace<Key>> numbers(keys.size());
    for (std::size_t i = 0; i < size; ++i) {
      keys[i] = listed[i].key;
      numbers[i] = static_cast<ListedPlace<Key>>(i);
    }
    const auto found = kernels::select_listed(keys.data(), numbers.data(), size, static_cast<std::size_t>(rank));
    return {found.key, listed[static_cast<std::size_t>(found.place)].place};
  }

  const Store& store_;
  kernels::PlaceRange range_;
  std::uint64_t rank_;
  int axis_;
  std::uint64_t chunks_;
  std::vector<Chunk> lists_;
  std::uint64_t below_ = 0;
  std::uint64_t inside_ = 0;
};

// exchange_pairs() over lists of ranges. What is left to be looked at stays in the lists.
template <class Store>
std::uint64_t exchange_lists(Store& store, std::vector<kernels::PlaceRange>& a, kernels::Relation relation_a,
                             std::vector<kernels::PlaceRange>& b, kernels::Relation relation_b, int axis,
                             typename Store::Key key) {
  std::uint64_t pairs = 0;
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    kernels::MisplacedCursor<Store> one(store, a[i], axis, relation_a, key);
    kernels::MisplacedCursor<Store> other(store, b[j], axis, relation_b, key);
    pairs += kernels::exchange_pairs(store, one, other);
    const bool more_of_one = one.fill();
    a[i] = one.rest();
    if (!more_of_one) ++i;
    const bool more_of_other = more_of_one ? other.fill() : true;
    b[j] = other.rest();
    if (!more_of_other) ++j;
  }
  a.erase(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(i));
  b.erase(b.begin(), b.begin() + static_cast<std::ptrdiff_t>(j));
  return pairs;
}

// The end of an exchange: `above` and `below` are the parts of the two sides that may hold misplaced particles. With
// equal keys one of them may run out first, as in kernels::exchange_sides(). Returns how many pairs changed sides.
template <class Store>
std::uint64_t exchange_rest(Store& store, std::vector<kernels::PlaceRange>& above,
                            std::vector<kernels::PlaceRange>& below, kernels::PlaceRange left,
                            kernels::PlaceRange right, int axis, typename Store::Key median) {
  using kernels::Relation;
  std::uint64_t pairs = exchange_lists(store, above, Relation::greater, below, Relation::less, axis, median);
  std::vector<kernels::PlaceRange> partner = {right};
  pairs += exchange_lists(store, above, Relation::greater, partner, Relation::not_greater, axis, median);
  partner = {left};
  return pairs + exchange_lists(store, below, Relation::less, partner, Relation::not_less, axis, median);
}

// As kernels::exchange_sides(), with several threads: chunks of the two sides are dealt with in pairs, then what is
// left over of all of them.
template <class Store>
std::uint64_t exchange_sides_parallel(Store& store, kernels::PlaceRange left, kernels::PlaceRange right, int axis,
                                      typename Store::Key median) {
  using kernels::Relation;
  const std::uint64_t chunks = chunks_of(left.end - left.begin);
  if (chunks <= 1) return kernels::exchange_sides(store, left, right, axis, median);
  std::atomic<std::uint64_t> pairs{0};
  std::vector<kernels::PlaceRange> above(chunks);
  std::vector<kernels::PlaceRange> below(chunks);
  for_chunks(chunks, [&](std::uint64_t chunk) {
    kernels::MisplacedCursor<Store> l(store, chunk_of(left, chunk, chunks), axis, Relation::greater, median);
    kernels::MisplacedCursor<Store> r(store, chunk_of(right, chunk, chunks), axis, Relation::less, median);
    pairs += kernels::exchange_pairs(store, l, r);
    // Past all that is in place already, while there are many threads.
    l.fill();
    r.fill();
    above[chunk] = l.rest();
    below[chunk] = r.rest();
  });
  return pairs + exchange_rest(store, above, below, left, right, axis, median);
}

// Puts a particle with the median key to `mid`, keys that are not larger before it and keys that are not smaller behind
// it; returns the median. `moved` grows by the number of particles that changed their place.
template <class Store>
typename Store::Key split_range(Store& store, kernels::PlaceRange range, std::uint64_t mid, int axis,
                                std::atomic<std::uint64_t>& moved) {
  const auto median = MedianSearch<Store>(store, range, mid, axis).find();
  store.swap(mid, median.place);
  const std::uint64_t pairs =
      exchange_sides_parallel(store, {range.begin, mid}, {mid + 1, range.end}, axis, median.key);
  moved += 2 * (pairs + (mid != median.place ? 1 : 0));
  return median.key;
}

}  // namespace insitu
