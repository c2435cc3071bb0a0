// Colours for values: the built-in maps and those of the caller, all ending in one table of linear colours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace insitu {

// Linear RGB with opacity, all 0..1, not premultiplied.
struct Rgba {
  float r = 0, g = 0, b = 0, a = 1;
  friend bool operator==(const Rgba&, const Rgba&) = default;
};

enum class ColormapKind : uint32_t { continuous = 0, categorical = 1 };  // as INSITU_COLORMAP_*

// Immutable after construction; any number of threads may look colours up.
class Colormap {
 public:
  // `rgba`: sRGB 0..1 and opacity, 4 numbers per colour, at least one colour. Values outside of 0..1 are clamped, NaN
  // counts as 0. Throws std::invalid_argument when there is no colour or the size is no multiple of 4.
  static Colormap from_srgb(ColormapKind kind, std::span<const double> rgba);

  // Continuous: 0 is the first colour, 1 the last; values outside are clamped, infinities too.
  // Categorical: the value rounded down is a colour number, taken modulo the count; -1 is the last colour.
  // NaN, and with a categorical map an infinity, is bad_value.
  Rgba lookup(double value) const;

  // What lookup has no colour for.
  bool is_bad(double value) const;
  bool is_opaque() const { return is_opaque_; }

  ColormapKind kind() const { return kind_; }
  size_t table_size() const { return table_.size(); }

  // A greyish magenta that no built-in map contains: missing data stand out, and are not mistaken for small or large.
  static constexpr Rgba bad_value{0.4f, 0.1f, 0.4f, 1.0f};

 private:
  Colormap(ColormapKind kind, std::vector<Rgba> table);

  ColormapKind kind_;
  std::vector<Rgba> table_;  // continuous: 1024 steps or more; categorical: one entry per colour
  bool is_opaque_;
};

// "viridis", "inferno", "coolwarm", "categorical", "elements": the order in which messages list them.
const std::vector<std::string>& builtin_colormap_names();

// The map of that name, for as long as the process lives; nullptr when there is none.
// "elements" is categorical with the atomic number as index: 0 is an unknown element, 1 hydrogen, 118 the last one.
const Colormap* builtin_colormap(std::string_view name);

}  // namespace insitu
