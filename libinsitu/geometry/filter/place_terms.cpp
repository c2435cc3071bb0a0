#include "geometry/filter/place_terms.h"

namespace insitu {
namespace {

// Bit i: holds(x, y, z) of the item at place i.
template <class Holds>
std::uint64_t word_of_points(const WorldPositions& world, const FilterBlock& block, const Holds& holds) {
  return with_scalars(world.position, [&](const auto& column) {
    const auto x = column(0);
    const auto y = column(1);
    const auto z = column(2);
    const auto at = [&](const auto& value, std::uint64_t item, int c) {
      return world.origin[c] + static_cast<double>(value(item)) * world.scale;
    };
    return word_of(block, [&](std::uint64_t item) { return holds(at(x, item, 0), at(y, item, 1), at(z, item, 2)); });
  });
}

}  // namespace

std::uint64_t BoxTerm::word(const FilterBlock& block) const {
  return word_of_points(world, block, [&](double x, double y, double z) -> bool {
    // Without branches: where particles stand in no order, none of them can be predicted.
    return (x >= lower[0]) & (x <= upper[0]) & (y >= lower[1]) & (y <= upper[1]) & (z >= lower[2]) & (z <= upper[2]);
  });
}

bool BoxTerm::accepts(std::uint64_t item) const {
  for (std::uint32_t c = 0; c < 3; ++c)
    if (!(world.at(item, c) >= lower[c] && world.at(item, c) <= upper[c])) return false;
  return true;
}

std::uint64_t PlaneTerm::word(const FilterBlock& block) const {
  return word_of_points(world, block, [&](double x, double y, double z) -> bool {
    return plane[0] * x + plane[1] * y + plane[2] * z >= plane[3];
  });
}

bool PlaneTerm::accepts(std::uint64_t item) const {
  return plane[0] * world.at(item, 0) + plane[1] * world.at(item, 1) + plane[2] * world.at(item, 2) >= plane[3];
}

}  // namespace insitu
