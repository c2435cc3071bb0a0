// What --filter says: conditions on particles, as texts.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace replay {

struct FilterCondition {
  enum class Kind { range, set, box, plane };

  Kind kind = Kind::range;
  bool negated = false;
  std::string attribute;              // of range and set; may end in a component, as "velocity.x"
  std::array<double, 2> range = {};   // may be infinite
  std::vector<std::int64_t> members;  // of the set
  std::vector<double> numbers;        // of the box: lower and upper corner; of the plane: normal and offset
};

// Conditions one of which has to hold.
using FilterChoice = std::vector<FilterCondition>;

// "speed:0.5..2", "type=1,3", "box:X0,Y0,Z0,X1,Y1,Z1", "plane:A,B,C,D", each perhaps with "not " before it, and with
// " or " between them. Throws UsageError.
FilterChoice parse_filter(const std::string& text);

// Conditions that all have to hold, one of each choice: one alternative for every way to choose. Throws UsageError when
// that is more than the library takes.
std::vector<std::vector<FilterCondition>> alternatives_of(const std::vector<FilterChoice>& choices);

}  // namespace replay
