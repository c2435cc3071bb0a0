// What the pictures look like: camera, colours, light.
#pragma once

#include <insitu/insitu.h>

#include <array>

#include "picture.h"

namespace cosmo {

double particle_radius(const PictureDesc& desc);

// With a slab: straight onto a slice through the centre of the box, which fills the image. Otherwise onto the box from
// outside; insitu_view_fit finds the distance.
insitu_camera camera_for(const PictureDesc& desc);
insitu_effects effects_for(const PictureDesc& desc);

// Night for the voids, embers for the filaments, white for the clusters.
insitu_colormap_desc color_map();
void color_range(ColorBy color_by, double range[2]);

std::array<insitu_light, 2> lights();
// Linear RGB and opacity: a void without a particle.
constexpr std::array<double, 4> background = {0.0015, 0.0015, 0.004, 1.0};

}  // namespace cosmo
