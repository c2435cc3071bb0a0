// One step of a file: where the particles are and what is known of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "box.h"

namespace replay {

// A named value, or short vector, per particle: item i has its components at values[i * components].
// Three names have a meaning: "element" (atomic number, 0 = unknown), "type" (whole numbers) and "radius".
struct Attribute {
  std::string name;
  std::uint32_t components = 1;
  bool categorical = false;  // numbers that only tell things apart
  std::vector<double> values;
};

struct Frame {
  std::optional<std::uint64_t> step;  // only where the file states it
  std::optional<double> time;
  std::vector<double> position;  // x y z, x y z, ...
  std::vector<Attribute> attributes;
  Box box;

  std::size_t count() const { return position.size() / 3; }
  const Attribute* find(std::string_view name) const;
  Attribute* find(std::string_view name);
  // Adds an attribute without values. The reference lives until the next call.
  Attribute& add(std::string name, std::uint32_t components = 1, bool categorical = false);
  void remove(std::string_view name);
  // "element, type, velocity": for messages.
  std::string attribute_names() const;
};

// Adds what follows from the columns that files commonly have: vx, vy, vz become "velocity" and its length "speed";
// a "diameter" gives a "radius"; an "element" column that knows no element is dropped.
void derive_attributes(Frame& frame);

// Gives each particle the element of its type: atomic_number[0] is that of type 1. Types outside get 0.
void assign_elements(Frame& frame, const std::vector<int>& atomic_number);

}  // namespace replay
