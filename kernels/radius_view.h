// The radius of an item, from wherever the host has it. Nothing is owned or checked here.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "kernels/array_view.h"
#include "kernels/attribute_value.h"

namespace insitu::kernels {

// One for all, an array of its own, or a table: by type, or by the value of an attribute; but for the first, times
// `scale`.
struct RadiusView {
  enum class Kind : std::uint8_t { uniform, per_item, by_type, by_value };
  Kind kind = Kind::uniform;
  double uniform = 0.0;  // not scaled again
  double scale = 1.0;
  ArrayView array;              // per_item: the radii; by_type: the types; by_value: the values
  std::uint32_t component = 0;  // by_value: which, as attribute_value() takes it
  const double* table = nullptr;
  std::uint64_t table_size = 0;
  // by_value: where the table begins, and its entries per unit. Linear between entries, of which there are two or more;
  // the first and the last go on beyond.
  double table_begin = 0.0;
  double table_density = 0.0;

  // Negative, zero, non-finite, a type outside of the table, or a value that is not a number: such items are never put
  // into a tree.
  double value(std::uint64_t item) const {
    switch (kind) {
      case Kind::uniform:
        return uniform;
      case Kind::per_item:
        return array.value(item) * scale;
      case Kind::by_type: {
        const double type = array.value(item);
        if (!(type >= 0.0 && type < static_cast<double>(table_size))) return 0.0;
        return table[static_cast<std::uint64_t>(type)] * scale;
      }
      case Kind::by_value:
        return of_value(attribute_value(array, item, component)) * scale;
    }
    return 0.0;
  }

 private:
  double of_value(double v) const {
    if (std::isnan(v)) return 0.0;
    const double last = static_cast<double>(table_size - 1);
    const double at = (v - table_begin) * table_density;
    if (!(at > 0.0)) return table[0];
    if (!(at < last)) return table[table_size - 1];
    const auto below = static_cast<std::uint64_t>(at);
    const double part = at - static_cast<double>(below);
    return table[below] + part * (table[below + 1] - table[below]);
  }
};

inline RadiusView uniform_radius(double radius) {
  RadiusView view;
  view.uniform = radius;
  return view;
}

}  // namespace insitu::kernels
