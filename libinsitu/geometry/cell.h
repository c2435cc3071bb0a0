// A simulation cell: a corner and three edges, some of which repeat.
#pragma once

#include <array>
#include <cstdint>

namespace insitu {

struct Cell {
  double origin[3] = {};
  double edge[3][3] = {};
  bool periodic[3] = {};

  // Throws Error(invalid_argument) when a number is not finite or the edges lie in one plane.
  void prepare();

  // Coordinates in units of the edges; 0 to 1 is inside.
  void fraction_of(const double point[3], double fraction[3]) const;
  // The sum of edges times `count`, in the same order of operations for whoever asks.
  void offset_of(const double count[3], double offset[3]) const;
  // Which copy of the cell a point lies in; 0 along axes that do not repeat. A point of the upper face lies in the
  // next.
  void image_of(const double point[3], double image[3]) const;
  // The image of a difference that is nearest to 0. Exact when one is shorter than half the smallest height of the
  // cell, whatever its angles: its fractions are then below a half. Returns whether that is another one than `d`.
  bool nearest_image(double d[3]) const;
  // Distance between the two faces across an edge.
  double height(int axis) const { return height_[axis]; }

  bool repeats() const { return periodic[0] || periodic[1] || periodic[2]; }

 private:
  double inverse_[3][3] = {};  // rows: the gradients of the fractions
  double height_[3] = {};
};

}  // namespace insitu
