// Bounds of the centres at consecutive places, read where a Store (pkd_store.h) has them.
#pragma once

#include <algorithm>
#include <limits>

#include "geometry/pkd/pkd_store.h"

namespace insitu {

template <class Store>
kernels::PkdBox<typename Store::Key> bounds_of_places(const Store& store, std::uint64_t begin, std::uint64_t end) {
  using Key = typename Store::Key;
  kernels::PkdBox<Key> box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = std::numeric_limits<Key>::infinity();
    box.upper[axis] = -box.lower[axis];
  }
  if (begin == end) return box;
  if (store.is_packed()) {
    // They are drawn.
    kernels::bounds_of_finite_records(store.records(begin), static_cast<std::size_t>(end - begin), box.lower,
                                      box.upper);
    return box;
  }
  for (std::uint64_t place = begin; place < end; ++place) {
    for (int axis = 0; axis < 3; ++axis) {
      const Key key = store.key(place, axis);
      box.lower[axis] = std::min(box.lower[axis], key);
      box.upper[axis] = std::max(box.upper[axis], key);
    }
  }
  return box;
}

}  // namespace insitu
