#include "geometry/particles/particle_image.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include "core/error.h"
#include "kernels/slabs.h"

namespace insitu {
namespace {

constexpr std::size_t most_images = 4096;
constexpr std::size_t batch = 256;

}  // namespace

ParticleImage::ParticleImage(const Particles& particles, const Cell& cell, const OccupiedImage& image)
    : particles_(particles), cell_(cell), image_(image.image), lower_{}, upper_{} {
  const double radius = particles.shown_radius_max() * particles.position_scale();
  for (int c = 0; c < 3; ++c) {
    const double reach = radius + 1e-9 * (image.upper[c] - image.lower[c] + radius);
    lower_[c] = image.lower[c] - reach;
    upper_[c] = image.upper[c] + reach;
  }
}

void ParticleImage::bounds(double lower[3], double upper[3]) const {
  std::copy_n(lower_, 3, lower);
  std::copy_n(upper_, 3, upper);
}

bool ParticleImage::clip(kernels::Ray& ray) const {
  const kernels::RaySlabs::Span box =
      kernels::RaySlabs(ray.origin, ray.direction).span(lower_, upper_, ray.t_min, ray.t_max);
  if (!box.meets) return false;
  ray.t_min = std::max(ray.t_min, box.enter);
  ray.t_max = std::min(ray.t_max, box.leave);
  return true;
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
      if (!clip(ray)) continue;
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

std::vector<OccupiedImage> occupied_images(const Particles& particles, const Cell& cell) {
  using Images = std::map<std::array<double, 3>, OccupiedImage>;
  Images images;
  std::mutex mutex;
  const auto check = [](const Images& some) {
    if (some.size() > most_images)
      throw Error(INSITU_ERROR_UNSUPPORTED, "wrapping into the cell: the particles lie in more than 4096 images of it");
  };
  const auto include = [](Images& some, const OccupiedImage& one) {
    OccupiedImage& box = some.try_emplace(one.image, one).first->second;
    for (int c = 0; c < 3; ++c) {
      box.lower[c] = std::min(box.lower[c], one.lower[c]);
      box.upper[c] = std::max(box.upper[c], one.upper[c]);
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, particles.item_count(), 1 << 14), [&](const auto& range) {
    Images own;
    for (std::uint64_t item = range.begin(); item < range.end(); ++item) {
      if (!particles.shows(item)) continue;
      OccupiedImage at;
      particles.centre(item, at.lower);
      if (!std::all_of(at.lower, at.lower + 3, [](double x) { return std::abs(x) <= 1e100; })) continue;
      std::copy_n(at.lower, 3, at.upper);
      cell.image_of(at.lower, at.image.data());
      include(own, at);
      check(own);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [image, box] : own) include(images, box);
  });
  check(images);
  std::vector<OccupiedImage> list;
  for (const auto& [image, box] : images) list.push_back(box);
  return list;
}

}  // namespace insitu
