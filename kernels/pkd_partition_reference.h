// What the kernels of pkd_partition.h do, one by one: the tests hold those against these.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/pkd_partition.h"

namespace insitu::kernels {

template <class Key>
Key key_of_run(const KeyRun<Key>& run, std::size_t i) {
  return run.first[i * static_cast<std::size_t>(run.components) + static_cast<std::size_t>(run.axis)];
}

template <class Key>
std::vector<ListedPlace<Key>> reference_list_places(const KeyRun<Key>& run, std::size_t count, Relation relation,
                                                    Key pivot) {
  std::vector<ListedPlace<Key>> places;
  for (std::size_t i = 0; i < count; ++i)
    if (holds(relation, key_of_run(run, i), pivot)) places.push_back(static_cast<ListedPlace<Key>>(i));
  return places;
}

template <class Key>
BandCount reference_list_band(const KeyRun<Key>& run, std::size_t count, Key low, Key high,
                              ListedPlace<Key> first_place, std::vector<Key>& keys,
                              std::vector<ListedPlace<Key>>& places) {
  BandCount result;
  for (std::size_t i = 0; i < count; ++i) {
    const Key key = key_of_run(run, i);
    if (key < low) ++result.below;
    if (!(key >= low && key <= high)) continue;
    keys.push_back(key);
    places.push_back(first_place + static_cast<ListedPlace<Key>>(i));
  }
  result.inside = keys.size();
  return result;
}

template <class Key>
bool reference_bounds_of_records(const Key* first, std::size_t records, Key lower[3], Key upper[3]) {
  for (std::size_t i = 0; i < 3 * records; ++i)
    if (!std::isfinite(first[i])) return false;
  for (std::size_t c = 0; c < 3; ++c) {
    lower[c] = std::numeric_limits<Key>::infinity();
    upper[c] = -lower[c];
    for (std::size_t i = 0; i < records; ++i) {
      lower[c] = std::min(lower[c], first[3 * i + c]);
      upper[c] = std::max(upper[c], first[3 * i + c]);
    }
  }
  return true;
}

// The rules of pkd_tree.h by the standard library.
template <class Key>
void reference_order_items(PkdItem<Key>* items, std::size_t count, PkdBox<Key> box, const OrderScratch<Key>& scratch) {
  if (count <= scratch.leaf) return;
  if (box.is_point()) {
    std::iter_swap(items, std::min_element(items, items + count, [&](const PkdItem<Key>& a, const PkdItem<Key>& b) {
                     return scratch.prefer(scratch.context, a.local, b.local);
                   }));
    return;
  }
  const int axis = box.split_axis();
  const std::size_t mid = count / 2;
  std::nth_element(items, items + mid, items + count,
                   [axis](const PkdItem<Key>& a, const PkdItem<Key>& b) { return a.x[axis] < b.x[axis]; });
  PkdBox<Key> left = box;
  left.upper[axis] = box.lower[axis] = items[mid].x[axis];
  reference_order_items(items, mid, left, scratch);
  reference_order_items(items + mid + 1, count - mid - 1, box, scratch);
}

}  // namespace insitu::kernels
