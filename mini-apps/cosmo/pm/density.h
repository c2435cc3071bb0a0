// Mass on the mesh, and the density seen by particles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cloud.h"
#include "workers.h"

namespace cosmo {

class Density {
 public:
  Density(std::size_t nodes, double side) : nodes_(nodes), clouds_(nodes, side), weight_(nodes * nodes * nodes) {}

  // Counts the particles at the nodes, all of one mass. Sums of integers: exact, in any order, by any number of
  // threads.
  void deposit(std::span<const Vec3f> positions, Workers& workers);

  // Density at the place of each particle, in units of the mean, by the same clouds.
  void interpolate(std::span<const Vec3f> positions, std::span<float> out, Workers& workers) const;

  std::size_t nodes() const { return nodes_; }
  const Clouds& clouds() const { return clouds_; }
  // In units of Clouds::particle, x slowest.
  std::span<const std::uint64_t> weights() const { return weight_; }
  // From weights to density in units of the mean.
  double per_mean() const;
  std::uint64_t bytes() const { return weight_.size() * sizeof(std::uint64_t); }

 private:
  std::size_t nodes_;
  Clouds clouds_;
  std::vector<std::uint64_t> weight_;
  std::size_t particles_ = 0;
};

}  // namespace cosmo
