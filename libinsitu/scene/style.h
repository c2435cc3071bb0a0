// How a geometry looks: what insitu_style describes, and what it comes to with the data of a step.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "geometry/particles/particles.h"
#include "insitu/insitu.h"
#include "kernels/opacity.h"
#include "scene/colormap.h"

namespace insitu {

struct Style {
  bool by_attribute = false;
  std::string attribute;
  std::uint32_t component = 0;  // as in insitu_style
  bool fixed_range = false;
  double range[2] = {0.0, 1.0};
  std::string colormap_name = "viridis";
  std::uint64_t own_map = 0;  // id of an insitu_colormap; 0 = the map of that name
  Rgba color{0.8f, 0.8f, 0.8f, 1.0f};
  float opacity = 1.0f;                                   // times that of the map or colour
  std::shared_ptr<const std::vector<float>> opacity_map;  // times this, evenly spaced over the map; may be missing
};

// Throws Error(invalid_argument); names the valid colour maps when the one asked for is unknown.
Style make_style(const insitu_style& description);
// What only the map that a style means can tell. Throws Error(invalid_argument).
void check_map(const Style& style, const Colormap& map);
// Whether anything in these colours may be seen through.
bool is_transparent(const Style& style, const Colormap& map);

// Colours of a geometry in one step; borrows its arrays and the map.
class Colors {
 public:
  // Throws Error(invalid_argument) when the attribute does not exist; the text lists those that do. Reads no values.
  static void check(const Style& style, const Particles& particles);
  // Checks first. Reads the attribute once when the range is automatic: call within the workers.
  Colors(const Style& style, const Particles& particles, const Colormap& map);
  Rgba of(std::uint64_t item) const;
  ValueRange range() const { return range_; }

  bool are_transparent() const { return are_transparent_; }
  // The opacities of the items, for as long as this object lives and stays where it is.
  kernels::ItemOpacity opacity() const { return {&Colors::opacity_of, this}; }

 private:
  static float opacity_of(const void* self, std::uint64_t item) { return static_cast<const Colors*>(self)->of(item).a; }

  Rgba of_value(double value) const;  // without the style's own opacity

  const kernels::ArrayView* values_ = nullptr;  // nullptr: uniform
  const Colormap* map_;
  std::uint32_t component_;
  Rgba uniform_;
  float opacity_;
  std::shared_ptr<const std::vector<float>> opacity_map_;
  bool are_transparent_;
  ValueRange range_{0.0, 1.0};
};

}  // namespace insitu
