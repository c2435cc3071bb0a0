// Values of attributes: what a style colours by.
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/float_environment.h"
#include "geometry/particles/particles.h"
#include "kernels/attribute_value.h"

namespace insitu {

ValueRange value_range(const kernels::ArrayView& view, std::uint32_t component) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return tbb::parallel_reduce(
      tbb::blocked_range<std::uint64_t>(0, view.count, 1 << 14), ValueRange{infinity, -infinity},
      [&](const auto& range, ValueRange result) {
        const FloatEnvironment guard;
        for (std::uint64_t item = range.begin(); item < range.end(); ++item) {
          const double value = kernels::attribute_value(view, item, component);
          if (!std::isfinite(value)) continue;
          result.low = std::min(result.low, value);
          result.high = std::max(result.high, value);
        }
        return result;
      },
      [](const ValueRange& a, const ValueRange& b) {
        return ValueRange{std::min(a.low, b.low), std::max(a.high, b.high)};
      });
}

std::vector<std::string> Particles::describe_bad_values() const {
  std::vector<std::string> texts;
  for (const NamedView& attribute : arrays_->attributes) {
    const kernels::ArrayView& view = attribute.view;
    const std::uint64_t bad = tbb::parallel_reduce(
        tbb::blocked_range<std::uint64_t>(0, view.count, 1 << 14), std::uint64_t{0},
        [&](const auto& range, std::uint64_t sum) {
          for (std::uint64_t item = range.begin(); item < range.end(); ++item)
            for (std::uint32_t c = 0; c < view.components; ++c) sum += std::isfinite(view.value(item, c)) ? 0 : 1;
          return sum;
        },
        std::plus<>());
    if (bad != 0)
      texts.push_back("attribute '" + attribute.name + "' has " + std::to_string(bad) + " values that are not finite");
  }
  return texts;
}

}  // namespace insitu
