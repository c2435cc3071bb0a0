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

// Three vectors are whole records in each lane: lane k of them belongs to axis k mod 3.
template <class Key>
bool Bounds(const Key* first, std::size_t records, Key lower[3], Key upper[3]) {
  const KeyTag<Key> d;
  const std::size_t lanes = hn::Lanes(d);
  constexpr Key infinity = std::numeric_limits<Key>::infinity();
  const auto limit = hn::Set(d, infinity);
  auto low0 = limit;
  auto low1 = limit;
  auto low2 = limit;
  auto high0 = hn::Neg(limit);
  auto high1 = high0;
  auto high2 = high0;
  auto finite = hn::Lt(hn::Zero(d), limit);
  const std::size_t scalars = 3 * records;
  std::size_t i = 0;
  for (; i + 3 * lanes <= scalars; i += 3 * lanes) {
    const auto v0 = hn::LoadU(d, first + i);
    const auto v1 = hn::LoadU(d, first + i + lanes);
    const auto v2 = hn::LoadU(d, first + i + 2 * lanes);
    // False for NaN as well.
    finite = hn::And(
        finite, hn::And(hn::Lt(hn::Abs(v0), limit), hn::And(hn::Lt(hn::Abs(v1), limit), hn::Lt(hn::Abs(v2), limit))));
    low0 = hn::Min(low0, v0);
    low1 = hn::Min(low1, v1);
    low2 = hn::Min(low2, v2);
    high0 = hn::Max(high0, v0);
    high1 = hn::Max(high1, v1);
    high2 = hn::Max(high2, v2);
  }
  if (!hn::AllTrue(d, finite)) return false;
  HWY_ALIGN Key low[48];
  HWY_ALIGN Key high[48];
  hn::StoreU(low0, d, low);
  hn::StoreU(low1, d, low + lanes);
  hn::StoreU(low2, d, low + 2 * lanes);
  hn::StoreU(high0, d, high);
  hn::StoreU(high1, d, high + lanes);
  hn::StoreU(high2, d, high + 2 * lanes);
  Key box[2][3] = {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (std::size_t k = 0; k < 3 * lanes; ++k) {
    box[0][k % 3] = std::min(box[0][k % 3], low[k]);
    box[1][k % 3] = std::max(box[1][k % 3], high[k]);
  }
  for (; i < scalars; ++i) {
    if (!(std::abs(first[i]) < infinity)) return false;
    box[0][i % 3] = std::min(box[0][i % 3], first[i]);
    box[1][i % 3] = std::max(box[1][i % 3], first[i]);
  }
  std::copy_n(box[0], 3, lower);
  std::copy_n(box[1], 3, upper);
  return true;
}
bool BoundsF32(const float* first, std::size_t records, float lower[3], float upper[3]) {
  return Bounds(first, records, lower, upper);
}
bool BoundsF64(const double* first, std::size_t records, double lower[3], double upper[3]) {
  return Bounds(first, records, lower, upper);
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
