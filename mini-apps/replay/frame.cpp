#include "frame.h"

#include <algorithm>
#include <cmath>
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
    for (std::size_t c = 0; c < 3; ++c) velocity.values[3 * i + c] = parts[c]->values[i];
  }
  for (const char* name : {"vx", "vy", "vz"}) frame.remove(name);
  frame.attributes.push_back(std::move(velocity));
}

void add_speed(Frame& frame) {
  const Attribute* const velocity = frame.find("velocity");
  if (!velocity || velocity->components != 3 || frame.find("speed")) return;
  Attribute speed{"speed", 1, false, std::vector<double>(frame.count())};
  for (std::size_t i = 0; i < frame.count(); ++i) {
    const double* const v = &velocity->values[3 * i];
    speed.values[i] = std::hypot(v[0], v[1], v[2]);
  }
  frame.attributes.push_back(std::move(speed));
}

}  // namespace

void derive_attributes(Frame& frame) {
  join_velocity(frame);
  add_speed(frame);
  if (const Attribute* diameter = frame.find("diameter"); diameter && !frame.find("radius")) {
    Attribute radius{"radius", 1, false, diameter->values};
    for (double& value : radius.values) value /= 2;
    frame.attributes.push_back(std::move(radius));
  }
  if (const Attribute* element = frame.find("element")) {
    if (std::all_of(element->values.begin(), element->values.end(), [](double z) { return z == 0.0; })) {
      frame.remove("element");
    }
  }
}

void assign_elements(Frame& frame, const std::vector<int>& atomic_number) {
  const Attribute* const type = frame.find("type");
  if (!type || atomic_number.empty()) return;
  Attribute element{"element", 1, true, type->values};
  for (double& value : element.values) {
    const bool inside = value >= 1.0 && value <= static_cast<double>(atomic_number.size());
    value = inside ? static_cast<double>(atomic_number[static_cast<std::size_t>(value) - 1]) : 0.0;
  }
  frame.remove("element");
  frame.attributes.push_back(std::move(element));
}

}  // namespace replay
