#include "scene/colormap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "scene/srgb.h"

namespace insitu {
namespace {

using Color = std::array<double, 4>;

// A continuous table has at least this many steps. The published maps are even in what the eye sees, which sRGB values
// follow closely and linear ones do not: colours are mixed as sRGB, here, once. Between the entries of this fine table
// a lookup mixes linear values; the difference is far below one step of an 8 bit image.
constexpr size_t fewest_steps = 1024;

double clamped(double value) { return value > 0.0 ? std::min(value, 1.0) : 0.0; }  // NaN becomes 0

Rgba to_linear(const Color& srgb) {
  return {static_cast<float>(linear_of_srgb(srgb[0])), static_cast<float>(linear_of_srgb(srgb[1])),
          static_cast<float>(linear_of_srgb(srgb[2])), static_cast<float>(srgb[3])};
}

Color color_at(std::span<const double> rgba, size_t index) {
  return {clamped(rgba[4 * index]), clamped(rgba[4 * index + 1]), clamped(rgba[4 * index + 2]),
          clamped(rgba[4 * index + 3])};
}

// Every segment between two colours gets the same number of steps: all given colours are entries of the table.
std::vector<Rgba> fine_table(std::span<const double> rgba) {
  const size_t segments = rgba.size() / 4 - 1;
  if (segments == 0) return {to_linear(color_at(rgba, 0))};
  const size_t steps = (fewest_steps + segments - 1) / segments;
  std::vector<Rgba> table;
  table.reserve(segments * steps + 1);
  for (size_t segment = 0; segment < segments; ++segment) {
    const Color from = color_at(rgba, segment);
    const Color to = color_at(rgba, segment + 1);
    for (size_t step = 0; step < steps; ++step) {
      const double t = static_cast<double>(step) / static_cast<double>(steps);
      Color mixed;
      for (size_t c = 0; c < 4; ++c) mixed[c] = (1.0 - t) * from[c] + t * to[c];
      table.push_back(to_linear(mixed));
    }
  }
  table.push_back(to_linear(color_at(rgba, segments)));
  return table;
}

Rgba mix(const Rgba& from, const Rgba& to, float t) {
  const float s = 1.0f - t;
  return {s * from.r + t * to.r, s * from.g + t * to.g, s * from.b + t * to.b, s * from.a + t * to.a};
}

}  // namespace

Colormap Colormap::from_srgb(ColormapKind kind, std::span<const double> rgba) {
  if (rgba.empty() || rgba.size() % 4 != 0) {
    throw std::invalid_argument("a colour map needs at least one colour of four numbers");
  }
  if (kind == ColormapKind::continuous) return Colormap(kind, fine_table(rgba));
  std::vector<Rgba> table(rgba.size() / 4);
  for (size_t i = 0; i < table.size(); ++i) table[i] = to_linear(color_at(rgba, i));
  return Colormap(kind, std::move(table));
}

Colormap::Colormap(ColormapKind kind, std::vector<Rgba> table)
    : kind_(kind),
      table_(std::move(table)),
      is_opaque_(std::all_of(table_.begin(), table_.end(), [](const Rgba& color) { return color.a >= 1.0f; })) {}

bool Colormap::is_bad(double value) const {
  return std::isnan(value) || (kind_ == ColormapKind::categorical && std::isinf(value));
}

Rgba Colormap::lookup(double value) const {
  if (is_bad(value)) return bad_value;
  if (kind_ == ColormapKind::categorical) {
    const double count = static_cast<double>(table_.size());
    double index = std::fmod(std::floor(value), count);  // exact, whatever the magnitude
    if (index < 0.0) index += count;
    return table_[static_cast<size_t>(index)];
  }
  const double place = clamped(value) * static_cast<double>(table_.size() - 1);
  const size_t below = static_cast<size_t>(place);
  if (below + 1 >= table_.size()) return table_.back();
  return mix(table_[below], table_[below + 1], static_cast<float>(place - static_cast<double>(below)));
}

}  // namespace insitu
