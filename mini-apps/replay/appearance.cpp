#include "appearance.h"

#include <algorithm>
#include <cmath>

#include "elements.h"
#include "input_error.h"
#include "numbers.h"
#include "option_values.h"

namespace replay {
namespace {

// "velocity.x", "stress.4": the component, counted from 1; 0 when the text names none.
std::uint32_t component_in(const std::string& text, std::string& name) {
  const std::size_t dot = text.rfind('.');
  if (dot == std::string::npos || dot + 2 != text.size()) return 0;
  const std::size_t place = std::string_view("xyzw").find(text.back());
  name = text.substr(0, dot);
  if (place != std::string_view::npos) return static_cast<std::uint32_t>(place) + 1;
  return text.back() >= '1' && text.back() <= '4' ? static_cast<std::uint32_t>(text.back() - '0') : 0;
}

std::string fitting_colormap(const Attribute& attribute) {
  if (attribute.name == "element") return "elements";
  return attribute.categorical ? "categorical" : "viridis";
}

RadiusChoice vdw_radii(const Attribute& element) {
  RadiusChoice choice;
  choice.per_particle.resize(element.size());
  for_each_value(element.scalars, [&choice](std::size_t i, double z) {
    choice.per_particle[i] = z < 0.0 ? 0.0f : static_cast<float>(vdw_radius(atomic_number_of(z)));
  });
  return choice;
}

RadiusChoice radii_of(const Attribute& attribute) {
  RadiusChoice choice;
  choice.per_particle.resize(attribute.size());
  for_each_value(attribute.scalars,
                 [&choice](std::size_t i, double r) { choice.per_particle[i] = static_cast<float>(r); });
  return choice;
}

}  // namespace

const Attribute* find_component(const Frame& frame, const std::string& text, std::uint32_t& component) {
  if (const Attribute* attribute = frame.find(text)) return attribute;
  std::string name;
  component = component_in(text, name);
  const Attribute* const attribute = component > 0 ? frame.find(name) : nullptr;
  return attribute && component <= attribute->components ? attribute : nullptr;
}

ColorChoice choose_color(const Frame& frame, const Options& options) {
  ColorChoice choice;
  if (frame.count() == 0) return choice;
  choice.colormap = options.colormap;
  const Attribute* attribute = nullptr;
  if (options.color.empty()) {
    attribute = frame.find("element");
    if (!attribute) attribute = frame.find("type");
  } else {
    attribute = find_component(frame, options.color, choice.component);
  }
  if (attribute) {
    choice.attribute = attribute->name;
    if (choice.colormap.empty()) choice.colormap = fitting_colormap(*attribute);
    return choice;
  }
  if (options.color.empty() || options.color == "uniform") return choice;
  if (const auto color = parse_color(options.color)) {
    choice.color = *color;
    return choice;
  }
  throw UsageError("--color " + options.color + ": there is no such attribute, expected one of " +
                   frame.attribute_names() + ", or uniform, or a colour such as #4080c0");
}

namespace {

RadiusChoice mapped_radius(const Frame& frame, const std::string& name) {
  RadiusChoice choice;
  const Attribute* const attribute = find_component(frame, name, choice.component);
  if (!attribute) {
    throw UsageError("--radius " + name + ": there is no such attribute for --radius-map, expected one of " +
                     frame.attribute_names());
  }
  choice.mapped = attribute->name;
  return choice;
}

}  // namespace

RadiusChoice choose_radius(const Frame& frame, const Options& options) {
  if (frame.count() == 0) return {};
  const std::string& wish = options.radius;
  if (options.radius_map) return mapped_radius(frame, wish);
  const Attribute* const element = frame.find("element");
  if (wish.empty()) {
    if (const Attribute* radius = frame.find("radius")) return radii_of(*radius);
    return element ? vdw_radii(*element) : RadiusChoice{{}, frame.radius_for_all, {}, 0};
  }
  RadiusChoice choice;
  if (wish == "auto") return choice;
  if (wish == "vdw" && element) return vdw_radii(*element);
  if (parse_number(wish, choice.for_all)) {
    if (choice.for_all > 0.0 && std::isfinite(choice.for_all)) return choice;
    throw UsageError("--radius " + wish + ": expected a length above 0");
  }
  const Attribute* const attribute = frame.find(wish);
  if (attribute && attribute->components == 1) return radii_of(*attribute);
  if (wish == "vdw") {
    throw UsageError(
        "--radius vdw: the file names no elements, expected a length, auto or an attribute (--elements "
        "names those of the types)");
  }
  throw UsageError("--radius " + wish + ": there is no such attribute, expected one of " + frame.attribute_names() +
                   ", or a length, vdw or auto");
}

}  // namespace replay
