// What the build of a P-k-d tree moves: an index, packed coordinates, or any number of arrays together.
//
// Beside what kernels/pkd_exchange.h asks of a Store:
//   KeyRun<Key> keys(begin, count, axis, buffer)   coordinates of places, where they are or in `buffer`; count <=
//                                                  most_keys
//   bool is_packed()                   coordinates stand as x y z x y z ...
//   const Key* records(begin)          if they do: from that place on
//   void prefetch(begin, count)        asks for coordinates from memory; places behind the last one may be named
//   void swap(a, b)
//   bool prefer(a, b)                  the particle at place a is to be shown rather than the coincident one at b
//   void apply(begin, items, n, bytes) the particle now at begin + i is the one that was at begin + items[i].local;
//                                      `bytes` is memory for n times bytes_per_item
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "kernels/pkd_exchange.h"
#include "kernels/pkd_partition.h"
#include "kernels/pkd_positions.h"
#include "kernels/prefetch.h"

namespace insitu {

using kernels::KeyRun;
using kernels::ListedPlace;
using kernels::PkdItem;

constexpr std::size_t most_keys = 1024;

inline bool prefer_item(const kernels::PkdTree& tree, std::uint64_t a, std::uint64_t b) {
  return tree.prefer != nullptr ? tree.prefer(tree.prefer_context, a, b) : a < b;
}

// Reads coordinates one by one into a buffer, which has run_padding scalars more than it gets.
template <class Positions>
KeyRun<typename Positions::Key> gather_keys(const Positions& positions, std::uint64_t begin, std::size_t count,
                                            int axis, typename Positions::Key* buffer) {
  for (std::size_t i = 0; i < count; ++i) buffer[i] = positions.key(begin + i, axis);
  return {buffer, 1, true};
}

template <class Store>
std::size_t list_in_store(const Store& store, std::uint64_t begin, std::size_t count, int axis,
                          kernels::Relation relation, typename Store::Key pivot,
                          ListedPlace<typename Store::Key>* places) {
  typename Store::Key buffer[kernels::exchange_block + kernels::run_padding];
  return kernels::list_places(store.keys(begin, count, axis, buffer), count, relation, pivot, places);
}

// Nothing moves but the index.
template <class Positions, class Index>
class IndexStore {
 public:
  using Key = typename Positions::Key;
  using Place = ListedPlace<Key>;

  IndexStore(const kernels::PkdTree& tree, Index* index) : tree_(tree), positions_(tree), index_(index) {}

  static constexpr std::size_t bytes_per_item() { return sizeof(Index); }
  KeyRun<Key> keys(std::uint64_t begin, std::size_t count, int axis, Key* buffer) const {
    return gather_keys(positions_, begin, count, axis, buffer);
  }
  static constexpr bool is_packed() { return false; }
  static constexpr const Key* records(std::uint64_t) { return nullptr; }
  void prefetch(std::uint64_t, std::uint64_t) const {}
  Key key(std::uint64_t place, int axis) const { return positions_.key(place, axis); }
  std::size_t list(std::uint64_t begin, std::size_t count, int axis, kernels::Relation relation, Key pivot,
                   Place* places) const {
    return list_in_store(*this, begin, count, axis, relation, pivot, places);
  }
  void exchange(std::uint64_t left, const Place* left_places, std::uint64_t right, const Place* right_places,
                std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) std::swap(index_[left + left_places[i]], index_[right + right_places[i]]);
  }
  void swap(std::uint64_t a, std::uint64_t b) { std::swap(index_[a], index_[b]); }
  bool prefer(std::uint64_t a, std::uint64_t b) const { return prefer_item(tree_, index_[a], index_[b]); }

  void apply(std::uint64_t begin, const PkdItem<Key>* items, std::size_t n, std::byte* bytes) {
    std::memcpy(bytes, index_ + begin, n * sizeof(Index));
    for (std::size_t i = 0; i < n; ++i)
      std::memcpy(index_ + begin + i, bytes + items[i].local * sizeof(Index), sizeof(Index));
  }

 private:
  const kernels::PkdTree& tree_;
  Positions positions_;  // through index_
  Index* index_;
};

// Coordinates alone, packed as x y z x y z ...
template <class K>
struct PkdRecord {
  K x[3];
};

// Packed coordinates that no other array belongs to.
template <class K>
class PackedStore {
 public:
  using Key = K;
  using Place = ListedPlace<Key>;

  PackedStore(const kernels::PkdTree& tree, PkdRecord<K>* records) : tree_(tree), records_(records) {}

  static constexpr std::size_t bytes_per_item() { return 0; }
  KeyRun<Key> keys(std::uint64_t begin, std::size_t, int axis, Key*) const {
    return {records_[begin].x, 3, false, axis};
  }
  static constexpr bool is_packed() { return true; }
  const Key* records(std::uint64_t begin) const { return records_[begin].x; }
  void prefetch(std::uint64_t begin, std::uint64_t count) const {
    if (count != 0) kernels::prefetch_bytes(records_ + begin, count * sizeof(PkdRecord<K>));
  }
  Key key(std::uint64_t place, int axis) const { return records_[place].x[axis]; }
  std::size_t list(std::uint64_t begin, std::size_t count, int axis, kernels::Relation relation, Key pivot,
                   Place* places) const {
    return kernels::list_places(keys(begin, count, axis, nullptr), count, relation, pivot, places);
  }
  void exchange(std::uint64_t left, const Place* left_places, std::uint64_t right, const Place* right_places,
                std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      std::swap(records_[left + left_places[i]], records_[right + right_places[i]]);
  }
  void swap(std::uint64_t a, std::uint64_t b) { std::swap(records_[a], records_[b]); }
  bool prefer(std::uint64_t a, std::uint64_t b) const { return prefer_item(tree_, a, b); }

  void apply(std::uint64_t begin, const PkdItem<K>* items, std::size_t n, std::byte*) {
    for (std::size_t i = 0; i < n; ++i)
      if (items[i].local != i) std::memcpy(records_ + begin + i, items[i].x, sizeof items[i].x);
  }

 private:
  const kernels::PkdTree& tree_;
  PkdRecord<K>* records_;
};

// `bytes` of every item, `stride` apart: a column, or the part of a record that was handed over.
struct MovedColumn {
  std::byte* base;
  std::ptrdiff_t stride;
  std::size_t bytes;
  bool rows;  // base is a table of pointers to the bytes

  std::byte* at(std::uint64_t place) const {
    std::byte* entry = base + static_cast<std::ptrdiff_t>(place) * stride;
    return rows ? kernels::load<std::byte*>(entry) : entry;
  }
};

// Calls body(std::integral_constant) for the sizes that are common, so that copies become a few instructions; 0
// otherwise.
template <class Body>
void for_size(std::size_t bytes, const Body& body) {
  switch (bytes) {
    case 4:
      return body(std::integral_constant<std::size_t, 4>());
    case 8:
      return body(std::integral_constant<std::size_t, 8>());
    case 12:
      return body(std::integral_constant<std::size_t, 12>());
    case 24:
      return body(std::integral_constant<std::size_t, 24>());
    default:
      return body(std::integral_constant<std::size_t, 0>());
  }
}

// All arrays of a set of particles, moved together, record by record, as bytes.
template <class Positions>
class ColumnsStore {
 public:
  using Key = typename Positions::Key;
  using Place = ListedPlace<Key>;

  ColumnsStore(const kernels::PkdTree& tree, const std::vector<MovedColumn>& columns)
      : tree_(tree), positions_(tree), columns_(columns) {}

  // Longer records are moved part by part.
  static constexpr std::size_t bytes_per_item() { return 64; }
  KeyRun<Key> keys(std::uint64_t begin, std::size_t count, int axis, Key* buffer) const {
    if constexpr (std::is_same_v<Positions, kernels::PlacedPositions<Key>>) {
      if (positions_.packed_records()) return {positions_.scalars(begin, 0), 3, false, axis};
      if (positions_.packed_columns()) return {positions_.scalars(begin, axis), 1, false};
    }
    return gather_keys(positions_, begin, count, axis, buffer);
  }
  bool is_packed() const {
    if constexpr (std::is_same_v<Positions, kernels::PlacedPositions<Key>>) return positions_.packed_records();
    return false;
  }
  const Key* records(std::uint64_t begin) const {
    if constexpr (std::is_same_v<Positions, kernels::PlacedPositions<Key>>) return positions_.scalars(begin, 0);
    return nullptr;
  }
  void prefetch(std::uint64_t begin, std::uint64_t count) const { positions_.prefetch_run(begin, begin + count); }
  Key key(std::uint64_t place, int axis) const { return positions_.key(place, axis); }
  std::size_t list(std::uint64_t begin, std::size_t count, int axis, kernels::Relation relation, Key pivot,
                   Place* places) const {
    return list_in_store(*this, begin, count, axis, relation, pivot, places);
  }
  void exchange(std::uint64_t left, const Place* left_places, std::uint64_t right, const Place* right_places,
                std::size_t count) {
    for (const MovedColumn& column : columns_)
      for_size(column.bytes, [&](auto size) {
        for (std::size_t i = 0; i < count; ++i)
          swap_bytes<size>(column.at(left + left_places[i]), column.at(right + right_places[i]), column.bytes);
      });
  }
  void swap(std::uint64_t a, std::uint64_t b) {
    if (a == b) return;
    for (const MovedColumn& column : columns_) swap_bytes<0>(column.at(a), column.at(b), column.bytes);
  }
  bool prefer(std::uint64_t a, std::uint64_t b) const { return prefer_item(tree_, tree_.item(a), tree_.item(b)); }

  void apply(std::uint64_t begin, const PkdItem<Key>* items, std::size_t n, std::byte* bytes) {
    for (const MovedColumn& column : columns_) {
      for (std::size_t done = 0; done < column.bytes; done += bytes_per_item()) {
        const std::size_t part = std::min(bytes_per_item(), column.bytes - done);
        for_size(part, [&](auto size) {
          const std::size_t length = size == 0 ? part : size;
          for (std::size_t i = 0; i < n; ++i)
            if (items[i].local != i) std::memcpy(bytes + i * length, column.at(begin + i) + done, length);
          for (std::size_t i = 0; i < n; ++i)
            if (items[i].local != i) std::memcpy(column.at(begin + i) + done, bytes + items[i].local * length, length);
        });
      }
    }
  }

 private:
  template <std::size_t size>
  static void swap_bytes(std::byte* a, std::byte* b, std::size_t bytes) {
    std::byte buffer[64];
    if constexpr (size != 0) {
      std::memcpy(buffer, a, size);
      std::memcpy(a, b, size);
      std::memcpy(b, buffer, size);
    } else {
      for (std::size_t done = 0; done < bytes; done += sizeof buffer) {
        const std::size_t part = std::min(sizeof buffer, bytes - done);
        std::memcpy(buffer, a + done, part);
        std::memcpy(a + done, b + done, part);
        std::memcpy(b + done, buffer, part);
      }
    }
  }

  const kernels::PkdTree& tree_;
  Positions positions_;
  const std::vector<MovedColumn>& columns_;
};

}  // namespace insitu
