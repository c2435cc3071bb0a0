#include "kernels/pkd_partition.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/pkd_partition.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

#include "kernels/pkd_order-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

template <class Key>
std::size_t ListPlaces(const KeyRun<Key>& run, std::size_t count, Relation relation, Key pivot,
                       ListedPlace<Key>* places) {
  switch (run.components) {
    case 3:
      return ListPlacesOf<3>(run, count, relation, pivot, places);
    case 4:
      return ListPlacesOf<4>(run, count, relation, pivot, places);
    default:
      return ListPlacesOf<1>(run, count, relation, pivot, places);
  }
}
std::size_t ListPlacesF32(const KeyRun<float>& run, std::size_t count, Relation relation, float pivot,
                          std::uint32_t* places) {
  return ListPlaces(run, count, relation, pivot, places);
}
std::size_t ListPlacesF64(const KeyRun<double>& run, std::size_t count, Relation relation, double pivot,
                          std::uint64_t* places) {
  return ListPlaces(run, count, relation, pivot, places);
}

template <class Key>
BandCount ListBand(const KeyRun<Key>& run, std::size_t count, Key low, Key high, ListedPlace<Key> first_place,
                   Key* keys, ListedPlace<Key>* places) {
  switch (run.components) {
    case 3:
      return ListBandOf<3>(run, count, low, high, first_place, keys, places);
    case 4:
      return ListBandOf<4>(run, count, low, high, first_place, keys, places);
    default:
      return ListBandOf<1>(run, count, low, high, first_place, keys, places);
  }
}
BandCount ListBandF32(const KeyRun<float>& run, std::size_t count, float low, float high, std::uint32_t first_place,
                      float* keys, std::uint32_t* places) {
  return ListBand(run, count, low, high, first_place, keys, places);
}
BandCount ListBandF64(const KeyRun<double>& run, std::size_t count, double low, double high, std::uint64_t first_place,
                      double* keys, std::uint64_t* places) {
  return ListBand(run, count, low, high, first_place, keys, places);
}

Ranked<float> SelectF32(float* keys, std::uint32_t* places, std::size_t count, std::size_t rank) {
  return SelectListedOf(keys, places, count, rank);
}
Ranked<double> SelectF64(double* keys, std::uint64_t* places, std::size_t count, std::size_t rank) {
  return SelectListedOf(keys, places, count, rank);
}

template <class D, class Key, bool check>
struct LowHigh {
  hn::Vec<D> low;
  hn::Vec<D> high;
  hn::Mask<D> finite;

  explicit LowHigh(D d)
      : low(hn::Set(d, std::numeric_limits<Key>::infinity())),
        high(hn::Neg(low)),
        finite(hn::FirstN(d, hn::Lanes(d))) {}
  HWY_INLINE void Include(D d, hn::Vec<D> v) {
    low = hn::Min(low, v);
    high = hn::Max(high, v);
    // False for NaN as well.
    if constexpr (check) finite = hn::And(finite, hn::Lt(hn::Abs(v), hn::Set(d, std::numeric_limits<Key>::infinity())));
  }
  HWY_INLINE void Include(const LowHigh& other) {
    low = hn::Min(low, other.low);
    high = hn::Max(high, other.high);
    finite = hn::And(finite, other.finite);
  }
};

// One by one, `k` being the axis of the first scalar.
template <class Key, bool check>
bool IncludeScalars(const Key* first, std::size_t scalars, Key lower[3], Key upper[3]) {
  bool finite = true;
  for (std::size_t i = 0; i < scalars; ++i) {
    if constexpr (check) finite = finite && std::abs(first[i]) < std::numeric_limits<Key>::infinity();
    lower[i % 3] = std::min(lower[i % 3], first[i]);
    upper[i % 3] = std::max(upper[i % 3], first[i]);
  }
  return finite;
}

// A vector of four scalars for each record: its own three, and the first of the next; the last one, and `records` is at
// least 2, comes with the scalar before it, and is turned round.
template <class Key, bool check>
bool BoundsOfFew(const Key* first, std::size_t records, Key lower[3], Key upper[3]) {
  using D = hn::CappedTag<Key, 4>;
  const D d;
  LowHigh<D, Key, check> a(d);
  LowHigh<D, Key, check> b(d);
  std::size_t i = 0;
  for (; i + 2 < records; i += 2) {
    a.Include(d, hn::LoadU(d, first + 3 * i));
    b.Include(d, hn::LoadU(d, first + 3 * i + 3));
  }
  if (i + 1 < records) a.Include(d, hn::LoadU(d, first + 3 * i));
  const hn::RebindToSigned<D> di;
  const auto turned = hn::IndicesFromVec(d, hn::And(hn::Add(hn::Iota(di, 0), hn::Set(di, 1)), hn::Set(di, 3)));
  b.Include(d, hn::TableLookupLanes(hn::LoadU(d, first + 3 * records - 4), turned));
  a.Include(b);
  HWY_ALIGN Key low[4];
  HWY_ALIGN Key high[4];
  hn::Store(a.low, d, low);
  hn::Store(a.high, d, high);
  std::copy_n(low, 3, lower);
  std::copy_n(high, 3, upper);
  return hn::AllTrue(d, a.finite);
}

// Three vectors are whole records in each lane: lane k of them belongs to axis k mod 3.
template <class Key, bool check>
bool Bounds(const Key* first, std::size_t records, Key lower[3], Key upper[3]) {
  if constexpr (hn::MaxLanes(hn::CappedTag<Key, 4>()) == 4)
    if (records >= 2 && records < 64) return BoundsOfFew<Key, check>(first, records, lower, upper);
  const KeyTag<Key> d;
  const std::size_t lanes = hn::Lanes(d);
  constexpr Key infinity = std::numeric_limits<Key>::infinity();
  LowHigh<KeyTag<Key>, Key, check> v[3] = {LowHigh<KeyTag<Key>, Key, check>(d), LowHigh<KeyTag<Key>, Key, check>(d),
                                           LowHigh<KeyTag<Key>, Key, check>(d)};
  const std::size_t scalars = 3 * records;
  std::size_t i = 0;
  for (; i + 3 * lanes <= scalars; i += 3 * lanes)
    for (std::size_t part = 0; part < 3; ++part) v[part].Include(d, hn::LoadU(d, first + i + part * lanes));
  bool finite = true;
  std::fill_n(lower, 3, infinity);
  std::fill_n(upper, 3, -infinity);
  HWY_ALIGN Key low[16];
  HWY_ALIGN Key high[16];
  for (std::size_t part = 0; part < 3; ++part) {
    finite = finite && hn::AllTrue(d, v[part].finite);
    hn::StoreU(v[part].low, d, low);
    hn::StoreU(v[part].high, d, high);
    for (std::size_t k = 0; k < lanes; ++k) {
      const std::size_t axis = (part * lanes + k) % 3;
      lower[axis] = std::min(lower[axis], low[k]);
      upper[axis] = std::max(upper[axis], high[k]);
    }
  }
  return IncludeScalars<Key, check>(first + i, scalars - i, lower, upper) && finite;
}
bool BoundsF32(const float* first, std::size_t records, float lower[3], float upper[3]) {
  return Bounds<float, true>(first, records, lower, upper);
}
bool BoundsF64(const double* first, std::size_t records, double lower[3], double upper[3]) {
  return Bounds<double, true>(first, records, lower, upper);
}
void FiniteBoundsF32(const float* first, std::size_t records, float lower[3], float upper[3]) {
  Bounds<float, false>(first, records, lower, upper);
}
void FiniteBoundsF64(const double* first, std::size_t records, double lower[3], double upper[3]) {
  Bounds<double, false>(first, records, lower, upper);
}

void OrderF32(PkdItem<float>* items, std::size_t count, const PkdBox<float>& box, const OrderScratch<float>& scratch) {
  ItemOrder<float>(items, scratch).Order(0, count, box);
}
void OrderF64(PkdItem<double>* items, std::size_t count, const PkdBox<double>& box,
              const OrderScratch<double>& scratch) {
  ItemOrder<double>(items, scratch).Order(0, count, box);
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace insitu::kernels {

HWY_EXPORT(ListPlacesF32);
HWY_EXPORT(ListPlacesF64);
HWY_EXPORT(ListBandF32);
HWY_EXPORT(ListBandF64);
HWY_EXPORT(SelectF32);
HWY_EXPORT(SelectF64);
HWY_EXPORT(BoundsF32);
HWY_EXPORT(BoundsF64);
HWY_EXPORT(FiniteBoundsF32);
HWY_EXPORT(FiniteBoundsF64);
HWY_EXPORT(OrderF32);
HWY_EXPORT(OrderF64);

std::size_t list_places(const KeyRun<float>& run, std::size_t count, Relation relation, float pivot,
                        std::uint32_t* places) {
  return HWY_DYNAMIC_DISPATCH(ListPlacesF32)(run, count, relation, pivot, places);
}
std::size_t list_places(const KeyRun<double>& run, std::size_t count, Relation relation, double pivot,
                        std::uint64_t* places) {
  return HWY_DYNAMIC_DISPATCH(ListPlacesF64)(run, count, relation, pivot, places);
}
BandCount list_band(const KeyRun<float>& run, std::size_t count, float low, float high, std::uint32_t first_place,
                    float* keys, std::uint32_t* places) {
  return HWY_DYNAMIC_DISPATCH(ListBandF32)(run, count, low, high, first_place, keys, places);
}
BandCount list_band(const KeyRun<double>& run, std::size_t count, double low, double high, std::uint64_t first_place,
                    double* keys, std::uint64_t* places) {
  return HWY_DYNAMIC_DISPATCH(ListBandF64)(run, count, low, high, first_place, keys, places);
}
Ranked<float> select_listed(float* keys, std::uint32_t* places, std::size_t count, std::size_t rank) {
  return HWY_DYNAMIC_DISPATCH(SelectF32)(keys, places, count, rank);
}
Ranked<double> select_listed(double* keys, std::uint64_t* places, std::size_t count, std::size_t rank) {
  return HWY_DYNAMIC_DISPATCH(SelectF64)(keys, places, count, rank);
}
bool bounds_of_records(const float* first, std::size_t records, float lower[3], float upper[3]) {
  return HWY_DYNAMIC_DISPATCH(BoundsF32)(first, records, lower, upper);
}
bool bounds_of_records(const double* first, std::size_t records, double lower[3], double upper[3]) {
  return HWY_DYNAMIC_DISPATCH(BoundsF64)(first, records, lower, upper);
}
void bounds_of_finite_records(const float* first, std::size_t records, float lower[3], float upper[3]) {
  HWY_DYNAMIC_DISPATCH(FiniteBoundsF32)(first, records, lower, upper);
}
void bounds_of_finite_records(const double* first, std::size_t records, double lower[3], double upper[3]) {
  HWY_DYNAMIC_DISPATCH(FiniteBoundsF64)(first, records, lower, upper);
}
void order_items(PkdItem<float>* items, std::size_t count, const PkdBox<float>& box,
                 const OrderScratch<float>& scratch) {
  HWY_DYNAMIC_DISPATCH(OrderF32)(items, count, box, scratch);
}
void order_items(PkdItem<double>* items, std::size_t count, const PkdBox<double>& box,
                 const OrderScratch<double>& scratch) {
  HWY_DYNAMIC_DISPATCH(OrderF64)(items, count, box, scratch);
}

}  // namespace insitu::kernels
#endif
