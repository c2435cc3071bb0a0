#include "frame.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <type_traits>
#include <utility>

namespace replay {

const Attribute* Frame::find(std::string_view name) const {
  for (const Attribute& attribute : attributes) {
    if (attribute.name == name) return &attribute;
  }
  return nullptr;
}

Attribute* Frame::find(std::string_view name) {
  return const_cast<Attribute*>(static_cast<const Frame*>(this)->find(name));
}

Attribute& Frame::add(std::string name, std::uint32_t components, bool categorical) {
  attributes.push_back({std::move(name), components, categorical, {}});
  return attributes.back();
}

void Frame::remove(std::string_view name) {
  std::erase_if(attributes, [name](const Attribute& attribute) { return attribute.name == name; });
}

std::string Frame::attribute_names() const {
  std::string names;
  for (const Attribute& attribute : attributes) names += (names.empty() ? "" : ", ") + attribute.name;
  return names.empty() ? "none" : names;
}

namespace {

void join_velocity(Frame& frame) {
  const Attribute* const parts[3] = {frame.find("vx"), frame.find("vy"), frame.find("vz")};
  if (!parts[0] || !parts[1] || !parts[2] || frame.find("velocity")) return;
  Attribute velocity{"velocity", 3, false, std::vector<double>(3 * frame.count())};
  for (std::size_t i = 0; i < frame.count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) velocity.values()[3 * i + c] = parts[c]->at(i);
  }
  for (const char* name : {"vx", "vy", "vz"}) frame.remove(name);
  frame.attributes.push_back(std::move(velocity));
}

void add_speed(Frame& frame) {
  const Attribute* const velocity = frame.find("velocity");
  if (!velocity || velocity->components != 3 || frame.find("speed")) return;
  Attribute speed{"speed", 1, false, {}};
  std::visit(
      [&speed](const auto& v) {
        // Of the same type as the components, and of double where those are whole numbers.
        using T = typename std::decay_t<decltype(v)>::value_type;
        std::vector<std::conditional_t<std::is_same_v<T, float>, float, double>> lengths(v.size() / 3);
        for (std::size_t i = 0; i < lengths.size(); ++i) {
          const auto component = [&](std::size_t c) { return static_cast<double>(v[3 * i + c]); };
          lengths[i] =
              static_cast<std::decay_t<decltype(lengths[i])>>(std::hypot(component(0), component(1), component(2)));
        }
        speed.scalars = std::move(lengths);
      },
      velocity->scalars);
  frame.attributes.push_back(std::move(speed));
}

}  // namespace

void derive_attributes(Frame& frame) {
  join_velocity(frame);
  add_speed(frame);
  if (const Attribute* diameter = frame.find("diameter"); diameter && !frame.find("radius")) {
    Attribute radius{"radius", 1, false, std::vector<double>(diameter->size())};
    for_each_value(diameter->scalars, [&](std::size_t i, double value) { radius.values()[i] = value / 2; });
    frame.attributes.push_back(std::move(radius));
  }
  if (const Attribute* element = frame.find("element")) {
    bool any = false;
    for_each_value(element->scalars, [&any](std::size_t, double z) { any = any || z != 0.0; });
    if (!any) frame.remove("element");
  }
}

void sort_by(Frame& frame, std::string_view name) {
  const Attribute* const key = frame.find(name);
  if (!key || key->components != 1) return;
  std::vector<double> keys(key->size());
  for_each_value(key->scalars, [&keys](std::size_t i, double value) { keys[i] = value; });
  if (std::is_sorted(keys.begin(), keys.end())) return;
  std::vector<std::size_t> order(keys.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&keys](std::size_t a, std::size_t b) { return keys[a] < keys[b]; });
  const auto reorder = [&order](auto& values, std::size_t components) {
    auto sorted = values;
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (std::size_t c = 0; c < components; ++c) sorted[i * components + c] = values[order[i] * components + c];
    }
    values = std::move(sorted);
  };
  reorder(frame.position, 3);
  for (Attribute& attribute : frame.attributes) {
    std::visit([&](auto& values) { reorder(values, attribute.components); }, attribute.scalars);
  }
}

void assign_elements(Frame& frame, const std::vector<int>& atomic_number) {
  const Attribute* const type = frame.find("type");
  if (!type || atomic_number.empty()) return;
  Attribute element{"element", 1, true, std::vector<double>(type->size())};
  for_each_value(type->scalars, [&](std::size_t i, double value) {
    const bool inside = value >= 1.0 && value <= static_cast<double>(atomic_number.size());
    element.values()[i] = inside ? static_cast<double>(atomic_number[static_cast<std::size_t>(value) - 1]) : 0.0;
  });
  frame.remove("element");
  frame.attributes.push_back(std::move(element));
}

}  // namespace replay
