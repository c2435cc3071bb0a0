// The particles of a set that lie in one image of a periodic cell, for showing all of them within the cell: traced in
// the set's own tree, which stays as it is. Whoever draws it shifts it back by the image's offset.
#pragma once

#include <vector>

#include "geometry/cell.h"
#include "geometry/particles/particles.h"

namespace insitu {

// An image of the cell in which particles lie, and the box of their centres.
struct OccupiedImage {
  std::array<double, 3> image;
  double lower[3];
  double upper[3];
};

class ParticleImage final : public TransparentGeometry {
 public:
  ParticleImage(const Particles& particles, const Cell& cell, const OccupiedImage& image);

  const std::array<double, 3>& image() const { return image_; }

  void bounds(double lower[3], double upper[3]) const override;
  void first_hits(const kernels::Ray* rays, kernels::Hit* hits, std::size_t count) const override;
  void any_hits(const kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const override;
  Surface surface(std::uint64_t item, const double point[3]) const override { return particles_.surface(item, point); }
  void nearest_entries(const kernels::Ray& ray, std::uint32_t number, const kernels::ItemOpacity& opacity,
                       kernels::NearestEntries& entries) const override;
  kernels::OpticalDepth optical_depth(const kernels::Ray& ray, const kernels::ItemOpacity& opacity,
                                      kernels::OpticalDepth depth) const override;
  // Whether an item of the set lies in this image.
  bool holds(std::uint64_t item) const;

 private:
  // To the box, in which all of this image lies. False: the ray misses it.
  bool clip(kernels::Ray& ray) const;

  const Particles& particles_;
  const Cell& cell_;
  std::array<double, 3> image_;
  double lower_[3];
  double upper_[3];
};

// The images of the cell in which particles of the set lie, in ascending order. Call within the workers.
// Throws Error(unsupported) when there are more than 4096.
std::vector<OccupiedImage> occupied_images(const Particles& particles, const Cell& cell);

}  // namespace insitu
