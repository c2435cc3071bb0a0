// Lists of keys by SIMD. Included once per SIMD target.
#if defined(INSITU_KERNELS_PKD_PARTITION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PKD_PARTITION_INL_H_
#undef INSITU_KERNELS_PKD_PARTITION_INL_H_
#else
#define INSITU_KERNELS_PKD_PARTITION_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/pkd_partition.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// At most 16 lanes: list_slack and run_padding are made for them.
template <class Key>
using KeyTag = hn::CappedTag<Key, 16>;

template <int components, class Key>
HWY_INLINE hn::VFromD<KeyTag<Key>> LoadKeys(const Key* first, int axis) {
  const KeyTag<Key> d;
#if HWY_TARGET == HWY_SCALAR
  return hn::LoadU(d, first + axis);  // one lane
#else
  if constexpr (components == 1) {
    return hn::LoadU(d, first);
  } else {
    const std::size_t lanes = hn::Lanes(d);
    const auto v0 = hn::LoadU(d, first);
    const auto v1 = hn::LoadU(d, first + lanes);
    const auto v2 = hn::LoadU(d, first + 2 * lanes);
    if constexpr (components == 3) {
      // Key k is scalar 3k + axis of the three vectors.
      const hn::RebindToUnsigned<KeyTag<Key>> du;
      const auto iota = hn::Iota(du, ListedPlace<Key>{0});
      const auto scalar = hn::Add(hn::Set(du, static_cast<ListedPlace<Key>>(axis)), hn::Add(iota, hn::Add(iota, iota)));
      const auto n = static_cast<ListedPlace<Key>>(lanes);
      const auto lane = hn::IndicesFromVec(d, hn::And(scalar, hn::Set(du, static_cast<ListedPlace<Key>>(n - 1))));
      const auto in_v0 = hn::RebindMask(d, hn::Lt(scalar, hn::Set(du, n)));
      const auto in_v01 = hn::RebindMask(d, hn::Lt(scalar, hn::Set(du, static_cast<ListedPlace<Key>>(2 * n))));
      return hn::IfThenElse(in_v0, hn::TableLookupLanes(v0, lane),
                            hn::IfThenElse(in_v01, hn::TableLookupLanes(v1, lane), hn::TableLookupLanes(v2, lane)));
    } else {
      // Every fourth scalar: the even ones of the even ones.
      const auto v3 = hn::LoadU(d, first + 3 * lanes);
      return hn::ConcatEven(d, hn::ConcatEven(d, v3, v2), hn::ConcatEven(d, v1, v0));
    }
  }
#endif
}

// body(i, keys, valid): vector by vector, in order; `valid` marks the lanes that are there, and new.
template <int components, class Key, class Body>
HWY_INLINE void ForKeys(const KeyRun<Key>& run, std::size_t count, const Body& body) {
  const KeyTag<Key> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto all = hn::FirstN(d, lanes);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) body(i, LoadKeys<components>(run.first + i * components, run.axis), all);
  if (i == count) return;
  if (run.padded) {
    body(i, LoadKeys<components>(run.first + i * components, run.axis), hn::FirstN(d, count - i));
  } else if (count >= lanes) {
    // The last vector once more, for those of its keys that are new.
    const std::size_t last = count - lanes;
    body(last, LoadKeys<components>(run.first + last * components, run.axis), hn::Not(hn::FirstN(d, i - last)));
  } else {
    HWY_ALIGN Key few[16] = {};
    for (std::size_t k = 0; k < count; ++k) few[k] = run.first[k * components + static_cast<std::size_t>(run.axis)];
    body(0, hn::Load(d, few), hn::FirstN(d, count));
  }
}

template <class D, class Mask>
HWY_INLINE std::size_t AppendMasked(D d, hn::VFromD<D> v, Mask mask, hn::TFromD<D>* to) {
  hn::StoreU(hn::Compress(v, mask), d, to);
  return hn::CountTrue(d, mask);
}

template <Relation relation, class V>
HWY_INLINE auto Compare(V keys, V pivot) {
  if constexpr (relation == Relation::less) return hn::Lt(keys, pivot);
  if constexpr (relation == Relation::not_greater) return hn::Le(keys, pivot);
  if constexpr (relation == Relation::greater) return hn::Gt(keys, pivot);
  if constexpr (relation == Relation::not_less) return hn::Ge(keys, pivot);
}

template <int components, Relation relation, class Key>
HWY_INLINE std::size_t ListRelated(const KeyRun<Key>& run, std::size_t count, Key pivot, ListedPlace<Key>* places) {
  using Place = ListedPlace<Key>;
  const KeyTag<Key> d;
  const hn::RebindToUnsigned<KeyTag<Key>> du;
  const auto pivots = hn::Set(d, pivot);
  const auto iota = hn::Iota(du, Place{0});
  std::size_t listed = 0;
  ForKeys<components>(run, count, [&](std::size_t i, auto keys, auto valid) HWY_ATTR {
    const auto mask = hn::RebindMask(du, hn::And(Compare<relation>(keys, pivots), valid));
    listed += AppendMasked(du, hn::Add(iota, hn::Set(du, static_cast<Place>(i))), mask, places + listed);
  });
  return listed;
}

template <int components, class Key>
HWY_INLINE std::size_t ListPlacesOf(const KeyRun<Key>& run, std::size_t count, Relation relation, Key pivot,
                                    ListedPlace<Key>* places) {
  switch (relation) {
    case Relation::less:
      return ListRelated<components, Relation::less>(run, count, pivot, places);
    case Relation::not_greater:
      return ListRelated<components, Relation::not_greater>(run, count, pivot, places);
    case Relation::greater:
      return ListRelated<components, Relation::greater>(run, count, pivot, places);
    case Relation::not_less:
      return ListRelated<components, Relation::not_less>(run, count, pivot, places);
  }
  return 0;
}

template <int components, class Key>
HWY_INLINE BandCount ListBandOf(const KeyRun<Key>& run, std::size_t count, Key low, Key high,
                                ListedPlace<Key> first_place, Key* keys_out, ListedPlace<Key>* places_out) {
  using Place = ListedPlace<Key>;
  const KeyTag<Key> d;
  const hn::RebindToUnsigned<KeyTag<Key>> du;
  const auto lows = hn::Set(d, low);
  const auto highs = hn::Set(d, high);
  const auto iota = hn::Iota(du, first_place);
  std::size_t below = 0;
  std::size_t inside = 0;
  ForKeys<components>(run, count, [&](std::size_t i, auto keys, auto valid) HWY_ATTR {
    const auto not_below = hn::Ge(keys, lows);
    const auto mask = hn::And(hn::And(not_below, hn::Le(keys, highs)), valid);
    below += hn::CountTrue(d, hn::AndNot(not_below, valid));
    hn::StoreU(hn::Compress(hn::Add(iota, hn::Set(du, static_cast<Place>(i))), hn::RebindMask(du, mask)), du,
               places_out + inside);
    inside += AppendMasked(d, keys, mask, keys_out + inside);
  });
  return {below, inside};
}

// ------------------------------------------------------------------------------------------------ rank in a list -----

constexpr std::size_t most_pairs = 32;

// Ranks by comparing all with all: no branch on the data. The keys of ranks a and b, and where that of a stands. `keys`
// can be written up to whole vectors.
template <class Key>
struct TwoRanks {
  Key a;
  Key b;
  std::size_t at_a;
};

template <class Key>
HWY_INLINE TwoRanks<Key> RankAll(Key* keys, std::size_t count, std::size_t a, std::size_t b) {
  const KeyTag<Key> d;
  const std::size_t lanes = hn::Lanes(d);
  // Never of a rank that is asked for: below none.
  hn::StoreU(hn::Set(d, std::numeric_limits<Key>::infinity()), d, keys + count);
  const auto one = hn::Set(d, Key{1});
  const auto rank_a = hn::Set(d, static_cast<Key>(a));
  const auto rank_b = hn::Set(d, static_cast<Key>(b));
  TwoRanks<Key> result{};
  for (std::size_t j = 0; j < count; j += lanes) {
    const auto v = hn::LoadU(d, keys + j);
    auto less = hn::Zero(d);
    auto not_greater = hn::Zero(d);
    for (std::size_t i = 0; i < count; ++i) {
      const auto other = hn::Set(d, keys[i]);
      less = hn::IfThenElse(hn::Lt(other, v), hn::Add(less, one), less);
      not_greater = hn::IfThenElse(hn::Le(other, v), hn::Add(not_greater, one), not_greater);
    }
    const auto is_a = hn::And(hn::Le(less, rank_a), hn::Gt(not_greater, rank_a));
    const auto is_b = hn::And(hn::Le(less, rank_b), hn::Gt(not_greater, rank_b));
    const std::intptr_t lane_a = hn::FindFirstTrue(d, is_a);
    const std::intptr_t lane_b = hn::FindFirstTrue(d, is_b);
    if (lane_a >= 0) {
      result.at_a = j + static_cast<std::size_t>(lane_a);
      result.a = keys[result.at_a];
    }
    if (lane_b >= 0) result.b = keys[j + static_cast<std::size_t>(lane_b)];
  }
  return result;
}

// A band that holds the key of `rank` with good odds, from 16 or 64 keys (Floyd and Rivest, "Expected time bounds for
// selection", CACM 18(3), 1975).
template <class Key>
struct Band {
  Key low;
  Key high;
};

template <class Key, class KeyAt>
HWY_INLINE Band<Key> SampleBand(std::size_t count, std::size_t rank, const KeyAt& key_at) {
  constexpr std::size_t most = 64;
  Key sample[most + list_slack];
  const std::size_t size = count < 1000 ? 16 : most;
  const std::size_t step = count / size;
  for (std::size_t i = 0; i < size; ++i) sample[i] = key_at(i * step + step / 2);
  // The key of the wanted rank stands about here in the sorted sample, give or take half a root of its size.
  const std::size_t at = rank * size / count;
  const std::size_t margin = size == most ? 6 : 3;
  const std::size_t a = at > margin ? at - margin : 0;
  const std::size_t b = std::min(at + margin - 1, size - 1);
  const TwoRanks<Key> ranks = RankAll(sample, size, a, b);
  return {a == 0 ? -std::numeric_limits<Key>::infinity() : ranks.a,
          b + 1 == size ? std::numeric_limits<Key>::infinity() : ranks.b};
}

template <class Key>
HWY_INLINE Key Next(Key key) {
  return std::nextafter(key, std::numeric_limits<Key>::infinity());
}
template <class Key>
HWY_INLINE Key Previous(Key key) {
  return std::nextafter(key, -std::numeric_limits<Key>::infinity());
}

// Keeps the entries of a list whose keys are within the band; what is written has been read by then.
template <class Key>
HWY_INLINE std::size_t KeepBand(Key* keys, ListedPlace<Key>* places, std::size_t count, Band<Key> band) {
  const KeyTag<Key> d;
  const hn::RebindToUnsigned<KeyTag<Key>> du;
  const auto lows = hn::Set(d, band.low);
  const auto highs = hn::Set(d, band.high);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto v = hn::LoadU(d, keys + i);
    const auto mask = hn::And(hn::And(hn::Ge(v, lows), hn::Le(v, highs)), hn::FirstN(d, count - i));
    hn::StoreU(hn::Compress(hn::LoadU(du, places + i), hn::RebindMask(du, mask)), du, places + kept);
    kept += AppendMasked(d, v, mask, keys + kept);
  }
  return kept;
}

template <class Key>
Ranked<Key> SelectListedOf(Key* keys, ListedPlace<Key>* places, std::size_t count, std::size_t rank) {
  constexpr Key infinity = std::numeric_limits<Key>::infinity();
  const KeyTag<Key> d;
  bool stuck = false;
  while (count > most_pairs) {
    Band<Key> band = SampleBand<Key>(count, rank, [keys](std::size_t i) { return keys[i]; });
    // Many equal keys can keep a band from shrinking. Then a single key is asked for: it is the answer, or leaves.
    if (stuck) band.low = band.high = keys[count / 2];
    const auto lows = hn::Set(d, band.low);
    const auto highs = hn::Set(d, band.high);
    std::size_t below = 0;
    std::size_t not_above = 0;
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
      const auto v = hn::LoadU(d, keys + i);
      const auto valid = hn::FirstN(d, count - i);
      below += hn::CountTrue(d, hn::And(hn::Lt(v, lows), valid));
      not_above += hn::CountTrue(d, hn::And(hn::Le(v, highs), valid));
    }
    if (rank < below) {
      band = {-infinity, Previous(band.low)};
    } else if (rank >= not_above) {
      band = {Next(band.high), infinity};
      rank -= not_above;
    } else {
      rank -= below;
    }
    const std::size_t kept = KeepBand(keys, places, count, band);
    if (band.low == band.high) return {keys[0], places[0]};
    stuck = kept > count - count / 8;
    count = kept;
  }
  const TwoRanks<Key> found = RankAll(keys, count, rank, rank);
  return {found.a, places[found.at_a]};
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
