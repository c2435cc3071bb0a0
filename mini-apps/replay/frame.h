// One step of a file: where the particles are and what is known of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "box.h"
#include "scalars.h"

namespace replay {

// A named value, or short vector, per particle: item i has its components at i * components and behind.
// Three names have a meaning: "element" (atomic number, 0 = unknown, below 0 = no atom), "type" (whole numbers) and
// "radius".
struct Attribute {
  std::string name;
  std::uint32_t components = 1;
  bool categorical = false;  // numbers that only tell things apart
  Scalars scalars;           // double as long as nothing else is put there

  // Of attributes in doubles, as all text files give them.
  std::vector<double>& values() { return std::get<std::vector<double>>(scalars); }
  const std::vector<double>& values() const { return std::get<std::vector<double>>(scalars); }
  std::size_t size() const { return size_of(scalars); }
  double at(std::size_t i) const { return value_at(scalars, i); }
};

struct Frame {
  std::optional<std::uint64_t> step;  // only where the file states it
  std::optional<double> time;
  std::vector<double> position;  // x y z, x y z, ...
  std::vector<Attribute> attributes;
  Box box;
  double radius_for_all = 0.0;  // where there is no "radius"; 0: none is better than another

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

// Puts the particles into ascending order of an attribute of one component, those with equal values as they were.
void sort_by(Frame& frame, std::string_view name);

// Gives each particle the element of its type: atomic_number[0] is that of type 1. Types outside get 0.
void assign_elements(Frame& frame, const std::vector<int>& atomic_number);

}  // namespace replay
