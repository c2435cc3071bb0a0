// How the centre at a place of a tree is read: one small class per layout, chosen once per call of a kernel, so that
// the traversal itself has no branch on types. `Key` is the type in which coordinates are compared; is_exact_in_f32:
// centre_f32() loses nothing.
#pragma once

#include <type_traits>

#include "kernels/pkd_tree.h"
#include "kernels/prefetch.h"

namespace insitu::kernels {

// Whether the coordinates of an item stand too far from each other to come with one line of memory.
inline bool are_apart(const std::byte* const base[3]) {
  for (int c = 1; c < 3; ++c)
    if (base[c] < base[0] || base[c] - base[0] >= memory_line) return true;
  return false;
}

// f32 or f64 in tree order: record i of the tree is record i of the arrays.
template <class T>
class PlacedPositions {
 public:
  using Key = T;
  using Value = T;

  explicit PlacedPositions(const PkdTree& tree) : base_{}, stride_(tree.position.stride) {
    for (int c = 0; c < 3; ++c) base_[c] = tree.position.base[c];
    constexpr auto size = static_cast<std::ptrdiff_t>(sizeof(T));
    records_ = stride_ == 3 * size && base_[1] == base_[0] + size && base_[2] == base_[1] + size;
    columns_ = stride_ == size;
    apart_ = are_apart(base_);
  }
  T key(std::uint64_t place, int axis) const {
    return load<T>(base_[axis] + static_cast<std::ptrdiff_t>(place) * stride_);
  }
  static constexpr bool is_indirect = false;
  static constexpr bool is_exact_in_f32 = std::is_same_v<T, float>;
  static constexpr bool may_be_packed = true;  // see packed_records()
  void prefetch(std::uint64_t place) const {
    const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(place) * stride_;
    prefetch_line(base_[0] + offset);
    if (!apart_) return;
    prefetch_line(base_[1] + offset);
    prefetch_line(base_[2] + offset);
  }
  void prefetch_run(std::uint64_t begin, std::uint64_t end) const {
    if (begin >= end) return;
    const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(begin) * stride_;
    if (!apart_) return prefetch_items(base_[0] + offset, end - begin, stride_, 3 * sizeof(T));
    for (const std::byte* base : base_) prefetch_items(base + offset, end - begin, stride_, sizeof(T));
  }
  void centre(std::uint64_t place, double out[3]) const {
    for (int c = 0; c < 3; ++c) out[c] = static_cast<double>(key(place, c));
  }
  void centre_f32(std::uint64_t place, float out[3]) const {
    for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(key(place, c));
  }
  // Packed x y z x y z ..., or three packed columns: whole vectors can be loaded.
  bool packed_records() const { return records_; }
  bool packed_columns() const { return columns_; }
  const T* scalars(std::uint64_t place, int component) const {
    return reinterpret_cast<const T*>(base_[component] + static_cast<std::ptrdiff_t>(place) * stride_);
  }

 private:
  const std::byte* base_[3];
  std::ptrdiff_t stride_;
  bool records_;
  bool columns_;
  bool apart_;
};

// f32 or f64 through a 32-bit index.
template <class T>
class IndexedPositions {
 public:
  using Key = T;

  explicit IndexedPositions(const PkdTree& tree) : base_{}, stride_(tree.position.stride), index_(tree.index32) {
    for (int c = 0; c < 3; ++c) base_[c] = tree.position.base[c];
    apart_ = are_apart(base_);
  }
  T key(std::uint64_t place, int axis) const {
    return load<T>(base_[axis] + static_cast<std::ptrdiff_t>(index_[place]) * stride_);
  }
  // Reading a centre takes two reads, one after the other: prefetch() asks for the first, prefetch_behind() for the
  // second.
  static constexpr bool is_indirect = true;
  static constexpr bool is_exact_in_f32 = std::is_same_v<T, float>;
  static constexpr bool may_be_packed = false;
  void prefetch(std::uint64_t place) const { prefetch_line(index_ + place); }
  void prefetch_run(std::uint64_t begin, std::uint64_t end) const {
    if (begin < end) prefetch_bytes(index_ + begin, (end - begin) * sizeof *index_);
  }
  void prefetch_behind(std::uint64_t place) const {
    const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(index_[place]) * stride_;
    prefetch_line(base_[0] + offset);
    if (!apart_) return;
    prefetch_line(base_[1] + offset);
    prefetch_line(base_[2] + offset);
  }
  void centre(std::uint64_t place, double out[3]) const {
    const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(index_[place]) * stride_;
    for (int c = 0; c < 3; ++c) out[c] = static_cast<double>(load<T>(base_[c] + offset));
  }
  void centre_f32(std::uint64_t place, float out[3]) const {
    const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(index_[place]) * stride_;
    for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(load<T>(base_[c] + offset));
  }

 private:
  const std::byte* base_[3];
  std::ptrdiff_t stride_;
  bool apart_;
  const std::uint32_t* index_;
};

// Everything else: integers, rows, 64-bit indices. Integers below 2^53 are exact in double.
class GeneralPositions {
 public:
  using Key = double;

  explicit GeneralPositions(const PkdTree& tree) : tree_(tree) {}
  double key(std::uint64_t place, int axis) const {
    return tree_.position.value(tree_.position_of_place(place), static_cast<std::uint32_t>(axis));
  }
  static constexpr bool is_indirect = false;
  static constexpr bool is_exact_in_f32 = false;
  static constexpr bool may_be_packed = false;
  void prefetch(std::uint64_t place) const {
    if (tree_.position_by_place && !tree_.position.rows) prefetch_line(tree_.position.address(place, 0));
  }
  void prefetch_run(std::uint64_t begin, std::uint64_t end) const {
    if (begin < end && tree_.position_by_place && !tree_.position.rows)
      prefetch_items(tree_.position.address(begin, 0), end - begin, tree_.position.stride,
                     size_of(tree_.position.type));
  }
  void centre(std::uint64_t place, double out[3]) const { tree_.centre(place, out); }
  void centre_f32(std::uint64_t place, float out[3]) const {
    double centre[3];
    tree_.centre(place, centre);
    for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(centre[c]);
  }

 private:
  const PkdTree& tree_;
};

// Chosen at the start of a call. The build compares coordinates in the Key of the same class.
enum class PkdLayout { placed_f32, placed_f64, indexed_f32, indexed_f64, general };

inline PkdLayout layout_of(const PkdTree& tree) {
  const bool f32 = tree.position.type == Scalar::f32;
  if ((!f32 && tree.position.type != Scalar::f64) || tree.position.rows) return PkdLayout::general;
  if (tree.position_by_place) return f32 ? PkdLayout::placed_f32 : PkdLayout::placed_f64;
  if (tree.index32 != nullptr) return f32 ? PkdLayout::indexed_f32 : PkdLayout::indexed_f64;
  return PkdLayout::general;
}

inline bool compares_in_f32(PkdLayout layout) {
  return layout == PkdLayout::placed_f32 || layout == PkdLayout::indexed_f32;
}

}  // namespace insitu::kernels
