#include "geometry/cell.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace insitu {

void Cell::prepare() {
  const auto refuse = [](const char* text) {
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, std::string("cell: ") + text);
  };
  constexpr double largest = 1e100;  // as for positions
  double normal[3][3];
  double length[3];
  for (int i = 0; i < 3; ++i) {
    const double* u = edge[(i + 1) % 3];
    const double* v = edge[(i + 2) % 3];
    for (int c = 0; c < 3; ++c) {
      if (!(std::abs(origin[c]) <= largest)) refuse("origin is not finite, or above 1e100");
      if (!(std::abs(edge[i][c]) <= largest)) refuse("a vector is not finite, or above 1e100");
      normal[i][c] = u[(c + 1) % 3] * v[(c + 2) % 3] - u[(c + 2) % 3] * v[(c + 1) % 3];
    }
    length[i] = std::hypot(edge[i][0], edge[i][1], edge[i][2]);
  }
  for (int i = 0; i < 3; ++i) {
    double volume = 0.0;
    for (int c = 0; c < 3; ++c) volume += edge[i][c] * normal[i][c];
    height_[i] = std::abs(volume) / std::hypot(normal[i][0], normal[i][1], normal[i][2]);
    if (!(height_[i] > 1e-9 * length[i])) refuse("the three vectors lie in one plane");
    for (int c = 0; c < 3; ++c) inverse_[i][c] = normal[i][c] / volume;
  }
}

void Cell::fraction_of(const double point[3], double fraction[3]) const {
  double d[3];
  for (int c = 0; c < 3; ++c) d[c] = point[c] - origin[c];
  for (int i = 0; i < 3; ++i) fraction[i] = inverse_[i][0] * d[0] + inverse_[i][1] * d[1] + inverse_[i][2] * d[2];
}

void Cell::offset_of(const double count[3], double offset[3]) const {
  for (int c = 0; c < 3; ++c) offset[c] = count[0] * edge[0][c] + count[1] * edge[1][c] + count[2] * edge[2][c];
}

void Cell::image_of(const double point[3], double image[3]) const {
  double fraction[3];
  fraction_of(point, fraction);
  for (int i = 0; i < 3; ++i) image[i] = periodic[i] ? std::floor(fraction[i]) : 0.0;
}

bool Cell::nearest_image(double d[3]) const {
  double count[3];
  bool moves = false;
  for (int i = 0; i < 3; ++i) {
    const double fraction = inverse_[i][0] * d[0] + inverse_[i][1] * d[1] + inverse_[i][2] * d[2];
    // Halves towards 0 on either side, so that d and -d have opposite images.
    count[i] = periodic[i] ? std::copysign(std::ceil(std::abs(fraction) - 0.5), fraction) : 0.0;
    moves = moves || count[i] != 0.0;
  }
  if (!moves) return false;
  double offset[3];
  offset_of(count, offset);
  for (int c = 0; c < 3; ++c) d[c] -= offset[c];
  return true;
}

}  // namespace insitu
