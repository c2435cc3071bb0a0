// The periodic cube [0, side)^3.
#pragma once

#include <cmath>

#include "particle.h"

namespace melt {

struct Box {
  double side;

  double volume() const { return side * side * side; }

  // The image of `x` inside the box. A coordinate already inside is returned bit for bit.
  double wrapped(double x) const {
    if (x >= 0.0 && x < side) return x;
    x -= side * std::floor(x / side);
    return x >= 0.0 && x < side ? x : 0.0;  // rounding may land on `side` itself; NaN and the like end here too
  }
  Vec3 wrapped(const Vec3& p) const { return {wrapped(p[0]), wrapped(p[1]), wrapped(p[2])}; }

  // The shortest of the differences between two coordinates over all periodic images (Allen & Tildesley, Computer
  // Simulation of Liquids, 2nd ed., section 1.6). One shift is enough: positions leave the box by less than half a
  // side between wraps. It is odd in `d` to the last bit, so that forces obey Newton's third law exactly.
  double nearest(double d) const {
    const double half = 0.5 * side;
    return d > half ? d - side : (d < -half ? d + side : d);
  }
};

}  // namespace melt
