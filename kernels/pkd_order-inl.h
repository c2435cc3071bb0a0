// A block of particles put into the order of a tree, in cache. Included once per SIMD target.
#if defined(INSITU_KERNELS_PKD_ORDER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef INSITU_KERNELS_PKD_ORDER_INL_H_
#undef INSITU_KERNELS_PKD_ORDER_INL_H_
#else
#define INSITU_KERNELS_PKD_ORDER_INL_H_
#endif

#include <utility>

#include "kernels/pkd_exchange.h"
#include "kernels/pkd_partition-inl.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

template <class Key_>
class ItemOrder {
 public:
  using Key = Key_;
  using Place = ListedPlace<Key>;
  using Item = PkdItem<Key>;

  ItemOrder(Item* items, const OrderScratch<Key>& scratch) : items_(items), scratch_(scratch) {}

  void Order(std::size_t begin, std::size_t end, PkdBox<Key> box) {
    while (end - begin > scratch_.leaf) {
      if (box.is_point()) return PutPreferredFirst(begin, end);
      const int axis = box.split_axis();
      const std::size_t mid = begin + (end - begin) / 2;
      const Key median = PutMedian(begin, end, mid, axis);
      exchange_sides(*this, {begin, mid}, {mid + 1, end}, axis, median);
      PkdBox<Key> left = box;
      left.upper[axis] = box.lower[axis] = median;
      Order(begin, mid, left);
      begin = mid + 1;
    }
  }

  // The store of pkd_exchange.h.
  std::size_t list(std::uint64_t begin, std::size_t count, int axis, Relation relation, Key pivot,
                   Place* places) const {
    return ListPlacesOf<4>(RunAt(begin, axis), count, relation, pivot, places);
  }
  void exchange(std::uint64_t left, const Place* left_places, std::uint64_t right, const Place* right_places,
                std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) std::swap(items_[left + left_places[i]], items_[right + right_places[i]]);
  }

 private:
  KeyRun<Key> RunAt(std::uint64_t place, int axis) const { return {items_[place].x + axis, 4, true}; }

  // Brings an item with the median key to `mid`, and returns that key.
  Key PutMedian(std::size_t begin, std::size_t end, std::size_t mid, int axis) {
    constexpr Key infinity = std::numeric_limits<Key>::infinity();
    const std::size_t count = end - begin;
    const std::size_t rank = mid - begin;
    const Item* items = items_ + begin;
    const KeyRun<Key> run = RunAt(begin, axis);
    const Band<Key> band = SampleBand<Key>(count, rank, [items, axis](std::size_t i) { return items[i].x[axis]; });
    BandCount listed = ListBandOf<4>(run, count, band.low, band.high, Place{0}, scratch_.keys, scratch_.places);
    if (rank < listed.below) {
      listed = ListBandOf<4>(run, count, -infinity, Previous(band.low), Place{0}, scratch_.keys, scratch_.places);
    } else if (rank >= listed.below + listed.inside) {
      listed = ListBandOf<4>(run, count, Next(band.high), infinity, Place{0}, scratch_.keys, scratch_.places);
    }
    const Ranked<Key> median = SelectListedOf(scratch_.keys, scratch_.places, static_cast<std::size_t>(listed.inside),
                                              rank - static_cast<std::size_t>(listed.below));
    std::swap(items_[mid], items_[begin + static_cast<std::size_t>(median.place)]);
    return median.key;
  }

  // Of particles at one point the one to be shown stands first (kernels/pkd_traverse.cc relies on it).
  void PutPreferredFirst(std::size_t begin, std::size_t end) {
    std::size_t best = begin;
    for (std::size_t place = begin + 1; place < end; ++place)
      if (scratch_.prefer(scratch_.context, items_[place].local, items_[best].local)) best = place;
    std::swap(items_[begin], items_[best]);
  }

  Item* items_;
  OrderScratch<Key> scratch_;
};

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
