// What the build of a P-k-d tree moves: an index, packed coordinates, or any number of arrays together. The interface
// is the Store of kernels/pkd_select.h, and
//   bool prefer(a, b)              the particle at place a is to be shown rather than the coincident one at b
//   void apply(begin, items, n)    the particle now at begin + i is the one that was at begin + items[i].local
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "kernels/pkd_positions.h"
#include "kernels/pkd_select.h"
#include "kernels/pkd_tree.h"

namespace insitu {

// A particle in the scratch memory of the build: small subtrees are built there, in cache, and applied in one go.
template <class K>
struct PkdItem {
  K x[3];
  std::uint32_t local;  // place within the block
};

// Coordinates alone, packed as x y z x y z ...
template <class K>
struct PkdRecord {
  K x[3];
};

inline bool prefer_item(const kernels::PkdTree& tree, std::uint64_t a, std::uint64_t b) {
  return tree.prefer != nullptr ? tree.prefer(tree.prefer_context, a, b) : a < b;
}

// Nothing moves but the index.
template <class Positions, class Index>
class IndexStore {
 public:
  using Key = typename Positions::Key;

  IndexStore(const kernels::PkdTree& tree, Index* index) : tree_(tree), positions_(tree), index_(index) {}

  Key key(std::uint64_t place, int axis) const { return positions_.key(place, axis); }
  void swap(std::uint64_t a, std::uint64_t b) { std::swap(index_[a], index_[b]); }
  bool prefer(std::uint64_t a, std::uint64_t b) const { return prefer_item(tree_, index_[a], index_[b]); }

  template <class Below>
  std::uint64_t partition(std::uint64_t begin, std::uint64_t end, int axis, Key pivot, Below below) {
    std::uint64_t next = begin;
    for (std::uint64_t i = begin; i < end; ++i) {
      const bool is_below = below(positions_.key(i, axis), pivot);
      std::swap(index_[i], index_[next]);
      next += is_below ? 1 : 0;
    }
    return next;
  }
  void apply(std::uint64_t begin, const PkdItem<Key>* items, std::size_t n) {
    const std::vector<Index> before(index_ + begin, index_ + begin + n);
    for (std::size_t i = 0; i < n; ++i) index_[begin + i] = before[items[i].local];
  }

 private:
  const kernels::PkdTree& tree_;
  Positions positions_;  // through index_
  Index* index_;
};

// Packed coordinates that no other array belongs to.
template <class K>
class PackedStore : public kernels::RecordStore<PkdRecord<K>> {
 public:
  using Key = K;

  PackedStore(const kernels::PkdTree& tree, PkdRecord<K>* records)
      : kernels::RecordStore<PkdRecord<K>>(records), tree_(tree), records_(records) {}

  bool prefer(std::uint64_t a, std::uint64_t b) const { return prefer_item(tree_, a, b); }
  void apply(std::uint64_t begin, const PkdItem<K>* items, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) std::memcpy(records_ + begin + i, items[i].x, sizeof items[i].x);
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

// All arrays of a set of particles, moved together, record by record, as bytes.
template <class Positions>
class ColumnsStore {
 public:
  using Key = typename Positions::Key;

  ColumnsStore(const kernels::PkdTree& tree, const std::vector<MovedColumn>& columns)
      : tree_(tree), positions_(tree), columns_(columns) {}

  Key key(std::uint64_t place, int axis) const { return positions_.key(place, axis); }
  bool prefer(std::uint64_t a, std::uint64_t b) const { return prefer_item(tree_, tree_.item(a), tree_.item(b)); }

  void swap(std::uint64_t a, std::uint64_t b) {
    if (a == b) return;
    for (const MovedColumn& column : columns_) swap_bytes(column.at(a), column.at(b), column.bytes);
  }

  // Hoare's: records may be long, so only those on the wrong side move.
  template <class Below>
  std::uint64_t partition(std::uint64_t begin, std::uint64_t end, int axis, Key pivot, Below below) {
    for (;;) {
      while (begin < end && below(positions_.key(begin, axis), pivot)) ++begin;
      while (begin < end && !below(positions_.key(end - 1, axis), pivot)) --end;
      if (begin == end) return begin;
      swap(begin, end - 1);
    }
  }

  void apply(std::uint64_t begin, const PkdItem<Key>* items, std::size_t n) {
    std::size_t longest = 0;
    for (const MovedColumn& column : columns_) longest = std::max(longest, column.bytes);
    std::vector<std::byte> before(longest * n);
    for (const MovedColumn& column : columns_) {
      for (std::size_t i = 0; i < n; ++i) std::memcpy(&before[i * column.bytes], column.at(begin + i), column.bytes);
      for (std::size_t i = 0; i < n; ++i)
        std::memcpy(column.at(begin + i), &before[items[i].local * column.bytes], column.bytes);
    }
  }

 private:
  static void swap_bytes(std::byte* a, std::byte* b, std::size_t bytes) {
    std::byte buffer[64];
    for (std::size_t done = 0; done < bytes; done += sizeof buffer) {
      const std::size_t part = std::min(sizeof buffer, bytes - done);
      std::memcpy(buffer, a + done, part);
      std::memcpy(a + done, b + done, part);
      std::memcpy(b + done, buffer, part);
    }
  }

  const kernels::PkdTree& tree_;
  Positions positions_;
  const std::vector<MovedColumn>& columns_;
};

}  // namespace insitu
