#include "look.h"

#include <cstdlib>

namespace cosmo {

static double env(const char* n, double d) {
  const char* s = std::getenv(n);
  return s ? std::atof(s) : d;
}

double particle_radius(const PictureDesc& desc) { return env("R", 0.3) * desc.spacing; }

insitu_camera camera_for(const PictureDesc& desc) {
  insitu_camera camera;
  insitu_camera_init(&camera);
  const double centre = 0.5 * desc.side;
  if (desc.slab > 0.0) {
    camera.kind = INSITU_CAMERA_ORTHOGRAPHIC;
    const double d[3] = {env("DX", 0.16), env("DY", 0.09), 0.98};
    for (int k = 0; k < 3; ++k) camera.look_at[k] = centre, camera.eye[k] = centre + 2.0 * desc.side * d[k];
    double len = 0;
    for (double x : d) len += 4 * desc.side * desc.side * x * x;
    len = __builtin_sqrt(len);
    camera.up[1] = 1.0;
    camera.height = desc.side * env("HEIGHT", 0.94);
    camera.near_clip = len - 0.5 * desc.slab;
    camera.far_clip = len + 0.5 * desc.slab;
  } else {
    camera.kind = INSITU_CAMERA_PERSPECTIVE;
    const double d[3] = {env("DX", 1.1), env("DY", 0.8), env("DZ", 1.5)};
    for (int k = 0; k < 3; ++k)
      camera.look_at[k] = centre, camera.eye[k] = centre + env("DIST", 1.0) * desc.side * d[k];
    camera.up[1] = 1.0;
    camera.near_clip = env("NEAR", 0);
    camera.fov_y_deg = env("FOV", 45);
  }
  return camera;
}

insitu_effects effects_for(const PictureDesc& desc) {
  insitu_effects effects;
  insitu_effects_init(&effects);
  if (desc.ao_samples > 0) effects.flags |= INSITU_EFFECT_AMBIENT_OCCLUSION;
  effects.ao_samples = desc.ao_samples;
  effects.ao_radius = env("AOR", 2.0) * desc.spacing;
  return effects;
}

insitu_colormap_desc color_map() {
  static const double rgba[] = {0.03, 0.03, 0.09, 1, 0.10, 0.08, 0.26, 1, 0.22, 0.12, 0.42, 1,
                                0.45, 0.16, 0.47, 1, 0.72, 0.25, 0.38, 1, 0.92, 0.43, 0.23, 1,
                                0.99, 0.69, 0.25, 1, 1.0,  0.90, 0.55, 1, 1.0,  1.0,  0.92, 1};
  insitu_colormap_desc desc;
  insitu_colormap_desc_init(&desc);
  desc.rgba = rgba;
  desc.count = 9;
  return desc;
}

void color_range(ColorBy color_by, double range[2]) {
  if (color_by == ColorBy::density) {
    range[0] = env("LO", -0.7);
    range[1] = env("HI", 2.7);
  } else {
    range[0] = 0.0;
    range[1] = env("HI", 1000.0);
  }
}

const insitu_light* lights(std::uint32_t* count) {
  static insitu_light list[2];
  list[0] = {sizeof(insitu_light), INSITU_LIGHT_AMBIENT, {}, {}, env("AMB", 0.8), 0, 0};
  list[1] = {sizeof(insitu_light),
             INSITU_LIGHT_DIRECTIONAL,
             {0.3, -0.5, 1},
             {},
             env("KEY", 0.3),
             INSITU_LIGHT_IN_CAMERA_SPACE,
             0};
  *count = 2;
  return list;
}

void set_background(double rgba[4]) {
  rgba[0] = 0.0015;
  rgba[1] = 0.0015;
  rgba[2] = 0.004;
  rgba[3] = 1;
}

}  // namespace cosmo
