#include "geometry/particles/particle_image.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <set>

#include "core/error.h"
#include "kernels/slabs.h"

namespace insitu {
namespace {

constexpr std::size_t most_images = 4096;
constexpr std::size_t batch = 256;

}  // namespace

ParticleImage::ParticleImage(const Particles& particles, const Cell& cell, const std::array<double, 3>& image)
    : particles_(particles), cell_(cell), image_(image), lower_{}, upper_{} {
  particles.bounds(lower_, upper_);
  // Whatever has its centre in the image lies in the box around its corners, by the largest radius larger.
  double low[3];
  double high[3];
  for (int c = 0; c < 3; ++c) {
    low[c] = std::numeric_limits<double>::infinity();
    high[c] = -low[c];
  }
  for (int corner = 0; corner < 8; ++corner) {
    double count[3];
    double offset[3];
    for (int i = 0; i < 3; ++i) count[i] = image[static_cast<std::size_t>(i)] + (corner >> i & 1);
    cell.offset_of(count, offset);
    for (int c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], cell.origin[c] + offset[c]);
      high[c] = std::max(high[c], cell.origin[c] + offset[c]);
    }
  }
  // Along axes that do not repeat the cell has no end: the bounds of the particles stay there.
  const bool all = cell.periodic[0] && cell.periodic[1] && cell.periodic[2];
  for (int c = 0; c < 3 && all; ++c) {
    const double reach = particles.tree().radius_max * particles.position_scale() + 1e-6 * (high[c] - low[c]);
    lower_[c] = std::max(lower_[c], low[c] - reach);
    upper_[c] = std::min(upper_[c], high[c] + reach);
  }
}

void ParticleImage::bounds(double lower[3], double upper[3]) const {
  std::copy_n(lower_, 3, lower);
  std::copy_n(upper_, 3, upper);
}

bool ParticleImage::holds(std::uint64_t item) const {
  double centre[3];
  double image[3];
  particles_.centre(item, centre);
  cell_.image_of(centre, image);
  return std::equal(image, image + 3, image_.begin());
}

// A particle of another image is passed by: the ray goes on behind the place where it was hit. What the ray then leaves
// without having been seen to enter has been passed by before; its centre is no better now.
void ParticleImage::first_hits(const kernels::Ray* rays, kernels::Hit* hits, std::size_t count) const {
  kernels::Ray going[batch];
  kernels::Hit found[batch];
  std::size_t place[batch];
  for (std::size_t begin = 0; begin < count; begin += batch) {
    std::size_t n = 0;
    for (std::size_t i = begin; i < std::min(count, begin + batch); ++i) {
      kernels::Ray ray = rays[i];
      ray.t_max = std::min(ray.t_max, hits[i].t);
      // Nothing of this image begins before the ray enters its box.
      const double enter = kernels::RaySlabs(ray.origin, ray.direction).enter(lower_, upper_, ray.t_min, ray.t_max);
      if (enter == std::numeric_limits<double>::infinity()) continue;
      ray.t_min = std::max(ray.t_min, enter > 0.0 ? enter * (1.0 - 1e-12) : enter);
      place[n] = i;
      going[n++] = ray;
    }
    while (n > 0) {
      std::fill_n(found, n, kernels::Hit{});
      particles_.first_hits(going, found, n);
      std::size_t left = 0;
      for (std::size_t k = 0; k < n; ++k) {
        if (!found[k].found()) continue;
        if (holds(found[k].item)) {
          if (found[k].t < hits[place[k]].t) hits[place[k]] = found[k];
          continue;
        }
        going[left] = going[k];
        going[left].t_min = found[k].t;
        place[left++] = place[k];
      }
      n = left;
    }
  }
}

void ParticleImage::any_hits(const kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const {
  kernels::Ray wanted[batch];
  kernels::Hit hits[batch];
  std::size_t place[batch];
  for (std::size_t begin = 0; begin < count; begin += batch) {
    std::size_t n = 0;
    for (std::size_t i = begin; i < std::min(count, begin + batch); ++i) {
      if (occluded[i] != 0) continue;
      place[n] = i;
      wanted[n++] = rays[i];
    }
    std::fill_n(hits, n, kernels::Hit{});
    first_hits(wanted, hits, n);
    for (std::size_t k = 0; k < n; ++k)
      if (hits[k].found()) occluded[place[k]] = 1;
  }
}

std::vector<std::array<double, 3>> occupied_images(const Particles& particles, const Cell& cell) {
  using Image = std::array<double, 3>;
  std::set<Image> images;
  std::mutex mutex;
  const auto refuse = [] {
    throw Error(INSITU_ERROR_UNSUPPORTED, "wrapping into the cell: the particles lie in more than 4096 images of it");
  };
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, particles.item_count(), 1 << 14), [&](const auto& range) {
    std::set<Image> own;
    Image last{};
    bool any = false;
    for (std::uint64_t item = range.begin(); item < range.end(); ++item) {
      double centre[3];
      Image image;
      particles.centre(item, centre);
      if (!(std::abs(centre[0]) <= 1e100 && std::abs(centre[1]) <= 1e100 && std::abs(centre[2]) <= 1e100)) continue;
      cell.image_of(centre, image.data());
      if (any && image == last) continue;
      any = true;
      last = image;
      own.insert(image);
      if (own.size() > most_images) refuse();
    }
    const std::lock_guard<std::mutex> lock(mutex);
    images.merge(own);
  });
  if (images.size() > most_images) refuse();
  return {images.begin(), images.end()};
}

}  // namespace insitu
