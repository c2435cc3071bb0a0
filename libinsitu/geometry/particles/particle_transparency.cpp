// Rays through particles that can be seen through.
#include "geometry/particles/particle_image.h"
#include "geometry/particles/particles.h"
#include "kernels/pkd_transparent.h"

namespace insitu {

kernels::Ray Particles::local_ray(const kernels::Ray& ray) const {
  kernels::Ray local = ray;
  for (int c = 0; c < 3; ++c) local.origin[c] = (ray.origin[c] - arrays_->position_origin[c]) / arrays_->position_scale;
  local.t_min /= arrays_->position_scale;
  local.t_max /= arrays_->position_scale;
  return local;
}

void Particles::nearest_entries(const kernels::Ray& ray, std::uint32_t number, const kernels::ItemOpacity& opacity,
                                kernels::NearestEntries& entries) const {
  kernels::pkd_nearest_entries(tree_, local_ray(ray), arrays_->position_scale, number, opacity, entries);
}

kernels::OpticalDepth Particles::optical_depth(const kernels::Ray& ray, const kernels::ItemOpacity& opacity,
                                               kernels::OpticalDepth depth) const {
  return kernels::pkd_optical_depth(tree_, local_ray(ray), opacity, depth);
}

namespace {

// Of the particles of one image: those of others count as not there.
struct OpacityWithin {
  const ParticleImage* image;
  const kernels::ItemOpacity* opacity;

  static float of(const void* context, std::uint64_t item) {
    const auto* self = static_cast<const OpacityWithin*>(context);
    return self->image->holds(item) ? self->opacity->of(item) : 0.0f;
  }
};

}  // namespace

void ParticleImage::nearest_entries(const kernels::Ray& ray, std::uint32_t number, const kernels::ItemOpacity& opacity,
                                    kernels::NearestEntries& entries) const {
  kernels::Ray clipped = ray;
  const OpacityWithin within{this, &opacity};
  if (clip(clipped)) particles_.nearest_entries(clipped, number, {&OpacityWithin::of, &within}, entries);
}

kernels::OpticalDepth ParticleImage::optical_depth(const kernels::Ray& ray, const kernels::ItemOpacity& opacity,
                                                   kernels::OpticalDepth depth) const {
  kernels::Ray clipped = ray;
  const OpacityWithin within{this, &opacity};
  return clip(clipped) ? particles_.optical_depth(clipped, {&OpacityWithin::of, &within}, depth) : depth;
}

}  // namespace insitu
