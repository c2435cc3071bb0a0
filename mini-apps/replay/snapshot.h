// What the snapshots of N-body and SPH codes have in common: kinds of particles that do not have the same arrays, files
// in pieces, and many names for the same quantities.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "frame.h"

namespace replay {

// Joins the arrays of the kinds to attributes of all particles.
class SnapshotBuilder {
 public:
  explicit SnapshotBuilder(Frame& frame) : frame_(frame) {}

  // Particles `first` and behind have these values. Calls for one name come in the order of the particles; those in
  // between have no such value: NaN, or 0 where it is a whole number.
  void add(const std::string& name, std::uint32_t components, std::size_t first, const Scalars& values);
  void add_positions(const Scalars& xyz);
  void add_type(std::int32_t type, std::size_t count);
  // After the last particle.
  void finish();

 private:
  Frame& frame_;
};

// "mass" for "Masses" and "MASS", and so on; a name that is not known stays as it is.
std::string attribute_name(std::string_view name_in_file);

// The edges of a periodic box that begins at the origin; none where an edge is not above 0.
Box cube(double x, double y, double z);

// A snapshot may be several files: name.0, name.1 or name.0.hdf5, name.1.hdf5, ...
struct PieceName {
  std::string before;  // "snap."
  std::string after;   // ".hdf5"
  std::uint64_t number = 0;

  std::string path(std::uint64_t piece) const { return before + std::to_string(piece) + after; }
};
std::optional<PieceName> piece_name(const std::string& path);

// Throws InputError unless `path` can be the first of `pieces` files; returns the names of all of them.
std::vector<std::string> paths_of_pieces(const std::string& path, std::uint64_t pieces);

}  // namespace replay
