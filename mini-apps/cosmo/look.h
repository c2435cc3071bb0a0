// What the pictures look like: camera, colours, light.
#pragma once

#include <insitu/insitu.h>

#include "picture.h"

namespace cosmo {

double particle_radius(const PictureDesc& desc);
insitu_camera camera_for(const PictureDesc& desc);
insitu_effects effects_for(const PictureDesc& desc);
insitu_colormap_desc color_map();
void color_range(ColorBy color_by, double range[2]);
const insitu_light* lights(std::uint32_t* count);
void set_background(double rgba[4]);

}  // namespace cosmo
