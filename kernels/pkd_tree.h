// The balanced P-k-d tree (Wald et al., "CPU Ray Tracing Large Particle Data with Balanced P-k-d Trees", IEEE Vis 2015)
// in an in-order layout: there are no nodes, only the order of the particles.
//
// The tree over places [begin, end) is
//   - a leaf when it holds at most leaf_size particles, in any order;
//   - a coincident leaf when its box has no extent at all: every particle stands at the same point;
//   - otherwise the particle at mid = begin + (end - begin) / 2, the tree over [begin, mid), whose particles are not
//     above it along the split axis, and the tree over [mid + 1, end), whose particles are not below it.
// The split axis is a long side of the box, see split_axis_of(); the box of a child is the parent's, clipped at the
// split plane. Build and traversal derive both the same way from the root box, so neither is stored. (The paper stores
// the axis in the low bits of the coordinates and puts the children of i at 2i+1 and 2i+2; in order, a subtree is one
// run of memory.)
#pragma once

#include "kernels/array_view.h"
#include "kernels/radius_view.h"
#include "kernels/ray.h"
#include "kernels/selected_copies.h"
#include "kernels/selected_places.h"

namespace insitu::kernels {

// Measured, for frames, single rays and builds: 32 was slower in all of them.
constexpr std::uint64_t pkd_leaf_size = 64;

// By how much a side counts where sides are compared. With equal weights the sides of a box that is nearly a cube, as
// those in a liquid are, would change their order from one step of a simulation to the next, and each time all
// particles of the box their places. So far apart, they change it where a side is 1.23 or 1.52 times as long as
// another: between the cube and the box of which one side has been halved.
template <class Key>
constexpr Key side_weights[3] = {Key(1), Key(13) / 16, Key(21) / 32};

// The axis across which a box with these sides is split: that of the longest side, as weighted.
template <class Key>
inline int split_axis_of(Key x, Key y, Key z) {
  y *= side_weights<Key>[1];
  z *= side_weights<Key>[2];
  // Without branches: which side is longest cannot be predicted.
  const int of_two = y > x ? 1 : 0;
  return z > (y > x ? y : x) ? 2 : of_two;
}

// The box of the centres of a subtree, in the type in which the build compares coordinates.
template <class Key>
struct PkdBox {
  Key lower[3];
  Key upper[3];

  int split_axis() const { return split_axis_of(upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]); }
  bool is_point() const { return lower[0] == upper[0] && lower[1] == upper[1] && lower[2] == upper[2]; }
};

// Of two items hit at exactly the same distance: true when `a` is to be shown, whatever their places in the tree.
using PreferItem = bool (*)(const void* context, std::uint64_t a, std::uint64_t b);

struct PkdTree {
  ArrayView position;                      // of the caller, or a copy
  const std::uint32_t* index32 = nullptr;  // place in the tree -> item; both NULL: places are items
  const std::uint64_t* index64 = nullptr;
  bool position_by_place = true;  // `position` stands in tree order; false: it is looked up through the index
  std::uint64_t count = 0;        // particles in the tree; the others of `position` are not drawn
  double lower[3] = {};           // box of the centres
  double upper[3] = {};
  double radius_max = 0.0;
  std::uint64_t built_leaf = pkd_leaf_size;  // the build goes on to leaves of this size; never above pkd_leaf_size
  RadiusView radius;                         // by item
  SelectedPlaces selected;                   // of the places below `count`, those that are drawn
  SelectedCopies copies;                     // of these; or none
  PreferItem prefer = nullptr;
  const void* prefer_context = nullptr;
  bool continues = false;  // hits found before are of the same particles, in another tree: `prefer` holds for them too

  std::uint64_t item(std::uint64_t place) const {
    if (index32 != nullptr) return index32[place];
    if (index64 != nullptr) return index64[place];
    return place;
  }
  std::uint64_t position_of_place(std::uint64_t place) const { return position_by_place ? place : item(place); }
  void centre(std::uint64_t place, double out[3]) const {
    const std::uint64_t at = position_of_place(place);
    for (std::uint32_t c = 0; c < 3; ++c) out[c] = position.value(at, c);
  }
};

}  // namespace insitu::kernels
