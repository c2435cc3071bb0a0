// Filters look at particles in blocks of 64 neighbouring places: a word of bits each.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/array_view.h"
#include "kernels/attribute_value.h"
#include "kernels/pkd_tree.h"

namespace insitu {

struct FilterBlock {
  static constexpr std::uint64_t most = 64;

  std::uint64_t count = 0;
  std::uint64_t item[most];  // who stands there
};

// Places [begin, begin + count) of a tree, looked up once for all terms.
inline void look_up(const kernels::PkdTree& tree, std::uint64_t begin, std::uint64_t count, FilterBlock& block) {
  block.count = count;
  if (tree.index32 != nullptr) {
    for (std::uint64_t i = 0; i < count; ++i) block.item[i] = tree.index32[begin + i];
  } else if (tree.index64 != nullptr) {
    for (std::uint64_t i = 0; i < count; ++i) block.item[i] = tree.index64[begin + i];
  } else {
    for (std::uint64_t i = 0; i < count; ++i) block.item[i] = begin + i;
  }
}

// Bit i: holds(item) of the item at place i.
template <class Holds>
std::uint64_t word_of(const FilterBlock& block, const Holds& holds) {
  std::uint64_t word = 0;
  for (std::uint64_t i = 0; i < block.count; ++i) word |= std::uint64_t{holds(block.item[i])} << i;
  return word;
}

// One component of an array as scalars of type T, without a choice per item.
template <class T>
class TypedColumn {
 public:
  TypedColumn(const kernels::ArrayView& view, std::uint32_t component)
      : base_(view.base[component]), stride_(view.stride) {}
  T operator()(std::uint64_t item) const {
    return kernels::load<T>(base_ + static_cast<std::ptrdiff_t>(item) * stride_);
  }

 private:
  const std::byte* base_;
  std::ptrdiff_t stride_;
};

// The same where rows stand anywhere.
template <class T>
class TypedRows {
 public:
  TypedRows(const kernels::ArrayView& view, std::uint32_t component)
      : table_(view.base[0]), stride_(view.stride), offset_(component * sizeof(T)) {}
  T operator()(std::uint64_t item) const {
    return kernels::load<T>(kernels::load<const std::byte*>(table_ + static_cast<std::ptrdiff_t>(item) * stride_) +
                            offset_);
  }

 private:
  const std::byte* table_;
  std::ptrdiff_t stride_;
  std::size_t offset_;
};

// Calls action(scalars) with scalars<T>(component) for the type and layout of `view`: chosen once per block.
template <class Action>
std::uint64_t with_scalars(const kernels::ArrayView& view, const Action& action) {
  const auto typed = [&](auto zero) {
    using T = decltype(zero);
    return view.rows ? action([&](std::uint32_t c) { return TypedRows<T>(view, c); })
                     : action([&](std::uint32_t c) { return TypedColumn<T>(view, c); });
  };
  switch (view.type) {
    case kernels::Scalar::f32:
      return typed(float{});
    case kernels::Scalar::f64:
      return typed(double{});
    case kernels::Scalar::i32:
      return typed(std::int32_t{});
    case kernels::Scalar::i64:
      return typed(std::int64_t{});
    case kernels::Scalar::u8:
      return typed(std::uint8_t{});
    case kernels::Scalar::u32:
      return typed(std::uint32_t{});
    case kernels::Scalar::u64:
      return typed(std::uint64_t{});
  }
  return 0;
}

// Bit i: holds(length) of the vector of the item at place i; `column` as with_scalars() gives it.
template <class Column, class Holds>
std::uint64_t word_of_lengths(const kernels::ArrayView& view, const Column& column, const FilterBlock& block,
                              const Holds& holds) {
  // Two components at least, four at most.
  const decltype(column(0)) part[4] = {column(0), column(1), column(view.components > 2 ? 2 : 0),
                                       column(view.components > 3 ? 3 : 0)};
  return word_of(block, [&](std::uint64_t item) {
    return holds(
        kernels::vector_length(view.components, [&](std::uint32_t c) { return static_cast<double>(part[c](item)); }));
  });
}

}  // namespace insitu
