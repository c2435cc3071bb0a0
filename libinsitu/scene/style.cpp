#include "scene/style.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace insitu {
namespace {

float between(const std::vector<float>& values, double place) {
  const double at = std::clamp(place, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  if (below + 1 >= values.size()) return values.back();
  const auto t = static_cast<float>(at - static_cast<double>(below));
  return (1.0f - t) * values[below] + t * values[below + 1];
}

std::shared_ptr<const std::vector<float>> read_opacity_map(const insitu_style& description) {
  const auto refuse = [](const std::string& text) {
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, "style: opacity_map " + text);
  };
  const std::uint64_t count = description.opacity_map_count;
  if (description.opacity_map == nullptr && count == 0) return nullptr;
  if (description.opacity_map == nullptr || count == 0) refuse("and opacity_map_count do not fit together");
  if (count > 65536) refuse("has more than 65536 opacities");
  if (description.color_by != INSITU_COLOR_ATTRIBUTE) refuse("needs INSITU_COLOR_ATTRIBUTE");
  std::vector<float> values;
  for (std::uint64_t i = 0; i < count; ++i) {
    const double opacity = description.opacity_map[i];
    if (!(opacity >= 0.0 && opacity <= 1.0)) refuse("has an entry that is not between 0 and 1");
    values.push_back(static_cast<float>(opacity));
  }
  return std::make_shared<const std::vector<float>>(std::move(values));
}

}  // namespace

Style make_style(const insitu_style& description) {
  const auto refuse = [](const std::string& text) { throw Error(INSITU_ERROR_INVALID_ARGUMENT, "style: " + text); };
  Style style;
  switch (description.color_by) {
    case INSITU_COLOR_UNIFORM:
      break;
    case INSITU_COLOR_ATTRIBUTE:
      style.by_attribute = true;
      break;
    default:
      refuse("color_by is neither INSITU_COLOR_UNIFORM nor INSITU_COLOR_ATTRIBUTE");
  }
  if (style.by_attribute) {
    if (description.attribute == nullptr || *description.attribute == '\0') refuse("attribute has no name");
    style.attribute = description.attribute;
  }
  style.component = description.component;
  if (style.component > 4) refuse("component is 0 (value or length) or 1 to 4");
  if (description.range_mode > INSITU_RANGE_FIXED) refuse("range_mode is neither AUTO nor FIXED");
  style.fixed_range = description.range_mode == INSITU_RANGE_FIXED;
  if (style.fixed_range) {
    style.range[0] = description.range[0];
    style.range[1] = description.range[1];
    if (!std::isfinite(style.range[0]) || !std::isfinite(style.range[1])) refuse("range is not finite");
  }
  if (description.colormap != nullptr) style.colormap_name = description.colormap;
  style.own_map = description.own_map.id;
  if (style.own_map == 0 && builtin_colormap(style.colormap_name) == nullptr) {
    std::string names;
    for (const std::string& name : builtin_colormap_names()) names += (names.empty() ? "" : ", ") + name;
    refuse("unknown colour map '" + style.colormap_name + "'; there are: " + names);
  }
  const double* rgb = description.color;
  for (int c = 0; c < 3; ++c)
    if (!(rgb[c] >= 0.0 && std::isfinite(rgb[c]))) refuse("color is negative or not finite");
  if (rgb[0] != 0.0 || rgb[1] != 0.0 || rgb[2] != 0.0)
    style.color = {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2]), 1.0f};
  if (!(description.opacity >= 0.0 && description.opacity <= 1.0)) refuse("opacity is not between 0 and 1");
  if (description.opacity != 0.0) style.opacity = static_cast<float>(description.opacity);
  style.opacity_map = read_opacity_map(description);
  return style;
}

void check_map(const Style& style, const Colormap& map) {
  if (style.opacity_map != nullptr && map.kind() == ColormapKind::categorical)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, "style: opacity_map needs a colour map that is continuous");
}

bool is_transparent(const Style& style, const Colormap& map) {
  if (style.opacity * (style.by_attribute ? 1.0f : style.color.a) < 1.0f) return true;
  if (!style.by_attribute) return false;
  const auto lets_through = [](float opacity) { return opacity < 1.0f; };
  return !map.is_opaque() || (style.opacity_map != nullptr &&
                              std::any_of(style.opacity_map->begin(), style.opacity_map->end(), lets_through));
}

void Colors::check(const Style& style, const Particles& particles) {
  if (!style.by_attribute) return;
  const kernels::ArrayView* values = particles.attribute(style.attribute);
  if (values == nullptr)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, particles.name() + ": there is no attribute '" + style.attribute +
                                                   "' to colour by; there are: " + particles.attribute_names());
  if (style.component > values->components)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, particles.name() + ": attribute '" + style.attribute + "' has " +
                                                   std::to_string(values->components) + " components, not " +
                                                   std::to_string(style.component));
}

Colors::Colors(const Style& style, const Particles& particles, const Colormap& map)
    : map_(&map),
      component_(style.component),
      uniform_(style.color),
      opacity_(style.opacity),
      opacity_map_(style.opacity_map),
      are_transparent_(is_transparent(style, map)) {
  check(style, particles);
  check_map(style, map);
  uniform_.a *= opacity_;
  if (!style.by_attribute) return;
  values_ = particles.attribute(style.attribute);
  if (map.kind() == ColormapKind::categorical) return;
  range_ = style.fixed_range ? ValueRange{style.range[0], style.range[1]} : value_range(*values_, component_);
}

Rgba Colors::of(std::uint64_t item) const {
  if (values_ == nullptr) return uniform_;
  const double value = kernels::attribute_value(*values_, item, component_);
  if (map_->is_bad(value)) return Colormap::bad_value;  // missing data stand out
  Rgba color = of_value(value);
  color.a *= opacity_;
  return color;
}

Rgba Colors::of_value(double value) const {
  if (map_->kind() == ColormapKind::categorical) return map_->lookup(value);
  // One value everywhere: the middle of the map. A falling range turns the map round. Halves keep the difference
  // finite.
  const double extent = 0.5 * range_.high - 0.5 * range_.low;
  const double place = extent == 0.0 ? 0.5 : (0.5 * value - 0.5 * range_.low) / extent;
  Rgba color = map_->lookup(place);
  if (opacity_map_ != nullptr) color.a *= between(*opacity_map_, place);
  return color;
}

}  // namespace insitu
