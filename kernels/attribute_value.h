// The value of an attribute that colours, filters and radii go by.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "kernels/array_view.h"

namespace insitu::kernels {

// The length of a vector whose component c is part(c), scaled by the largest of them: squares neither overflow nor
// vanish. NaN when a component is.
template <class Part>
double vector_length(std::uint32_t components, const Part& part) {
  double largest = 0.0;
  for (std::uint32_t c = 0; c < components; ++c) {
    const double size = std::abs(part(c));
    if (std::isnan(size)) return size;
    largest = std::max(largest, size);
  }
  if (largest == 0.0 || std::isinf(largest)) return largest;
  double sum = 0.0;
  for (std::uint32_t c = 0; c < components; ++c) {
    const double scaled = part(c) / largest;
    sum += scaled * scaled;
  }
  return largest * std::sqrt(sum);
}

// Of the only component, of one component (1 to 4), or the length of a vector (0).
inline double attribute_value(const ArrayView& view, std::uint64_t item, std::uint32_t component) {
  if (component > 0) return view.value(item, component - 1);
  if (view.components == 1) return view.value(item);
  return vector_length(view.components, [&](std::uint32_t c) { return view.value(item, c); });
}

}  // namespace insitu::kernels
