#include "look.h"

#include <algorithm>
#include <cmath>

namespace cosmo {
namespace {

// The slice is not parallel to the lattice that the particles start from, whose planes would show as stripes: layer by
// layer the lattice is shifted across the image by the two numbers, of its spacing, whose multiples leave the smallest
// gaps (the generalised golden ratio g = 1.3247, g^3 = g + 1: 1 - 1/g and 1 - 1/g^2).
constexpr double shift_x = 0.2451;
constexpr double shift_y = 0.4302;

struct Axes {
  double right[3], up[3], towards[3];  // unit vectors; the last one from what is seen to the eye
};

Axes slab_axes() {
  const double length = std::sqrt(shift_x * shift_x + shift_y * shift_y + 1.0);
  const double d[3] = {shift_x / length, shift_y / length, 1.0 / length};
  const double across = std::hypot(d[0], d[2]);
  const double r[3] = {d[2] / across, 0.0, -d[0] / across};
  return {{r[0], r[1], r[2]}, {d[1] * r[2], d[2] * r[0] - d[0] * r[2], -d[1] * r[0]}, {d[0], d[1], d[2]}};
}

// Half of the largest square image whose slab is nowhere cut by a face of the box.
double slab_half_width(double side, double slab) {
  const Axes axes = slab_axes();
  double half = side;
  for (int k = 0; k < 3; ++k) {
    const double free = 0.5 * side - 0.5 * slab * std::abs(axes.towards[k]);
    half = std::min(half, free / (std::abs(axes.right[k]) + std::abs(axes.up[k])));
  }
  return std::max(half, 0.1 * side);  // a slab as thick as the box has to be cut
}

}  // namespace

// A sixth of the spacing: about two pixels of a picture of 1024 in a run of 128^3. Smaller and the picture is dust,
// larger and the particles of voids hide what lies behind them. In the whole box more of them lie behind each other.
double particle_radius(const PictureDesc& desc) { return (desc.slab > 0.0 ? 0.15 : 0.1) * desc.spacing; }

insitu_camera camera_for(const PictureDesc& desc) {
  insitu_camera camera;
  insitu_camera_init(&camera);
  const double centre = 0.5 * desc.side;
  for (double& x : camera.look_at) x = centre;
  camera.up[1] = 1.0;
  if (desc.slab > 0.0) {
    const Axes axes = slab_axes();
    const double distance = 2.0 * desc.side;  // outside of the box; the view is orthographic
    for (int k = 0; k < 3; ++k) camera.eye[k] = centre + distance * axes.towards[k];
    camera.kind = INSITU_CAMERA_ORTHOGRAPHIC;
    const double aspect = static_cast<double>(desc.width) / static_cast<double>(desc.height);
    camera.height = 2.0 * slab_half_width(desc.side, desc.slab) / std::max(1.0, aspect);
    camera.near_clip = distance - 0.5 * desc.slab;
    camera.far_clip = distance + 0.5 * desc.slab;
  } else {
    constexpr double towards[3] = {1.1, 0.8, 1.5};
    for (int k = 0; k < 3; ++k) camera.eye[k] = centre + 2.0 * desc.side * towards[k];
  }
  return camera;
}

insitu_effects effects_for(const PictureDesc& desc) {
  insitu_effects effects;
  insitu_effects_init(&effects);
  if (desc.ao_samples > 0) effects.flags |= INSITU_EFFECT_AMBIENT_OCCLUSION;
  effects.ao_samples = desc.ao_samples;
  effects.ao_radius = desc.spacing;  // shades the depth of clusters and filaments; farther away it would darken all
  return effects;
}

insitu_colormap_desc color_map() {
  static constexpr double rgba[] = {0.03, 0.03, 0.09, 1.0, 0.10, 0.08, 0.26, 1.0, 0.22, 0.12, 0.42, 1.0,
                                    0.45, 0.16, 0.47, 1.0, 0.72, 0.25, 0.38, 1.0, 0.92, 0.43, 0.23, 1.0,
                                    0.99, 0.69, 0.25, 1.0, 1.00, 0.90, 0.55, 1.0, 1.00, 1.00, 0.92, 1.0};
  insitu_colormap_desc desc;
  insitu_colormap_desc_init(&desc);
  desc.rgba = rgba;
  desc.count = sizeof rgba / sizeof rgba[0] / 4;
  return desc;
}

void color_range(ColorBy color_by, double range[2]) {
  if (color_by == ColorBy::density) {
    range[0] = -0.7;  // log10: a fifth of the mean density, the inside of a void
    range[1] = 2.2;   // 160 times the mean, the outskirts of a cluster
  } else {
    range[0] = 0.0;
    range[1] = 1000.0;  // km/s: what falls into a cluster
  }
}

std::array<insitu_light, 2> lights() {
  std::array<insitu_light, 2> list{};
  list[0].struct_size = list[1].struct_size = sizeof(insitu_light);
  list[0].kind = INSITU_LIGHT_AMBIENT;
  list[0].intensity = 0.5;
  list[1].kind = INSITU_LIGHT_DIRECTIONAL;
  list[1].flags = INSITU_LIGHT_IN_CAMERA_SPACE;
  list[1].intensity = 1.2;
  list[1].direction[0] = 0.3;
  list[1].direction[1] = -0.5;
  list[1].direction[2] = 1.0;
  return list;
}

}  // namespace cosmo
