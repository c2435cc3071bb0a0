// Lights, with the defaults filled in.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "insitu/insitu.h"
#include "scene/camera.h"

namespace insitu {

struct Light {
  glm::dvec3 radiance{1.0};  // linear RGB times intensity
  glm::dvec3 towards{0.0};   // unit vector to the light
  bool directional = false;  // otherwise ambient
  bool in_camera_space = false;
};

// Throws Error(invalid_argument).
Light make_light(const insitu_light& description);
// A key light from the upper left behind the camera, and ambient light.
std::vector<Light> default_lights();
// The unit vector to the light in world space.
glm::dvec3 direction_to(const Light& light, const Camera& camera);

}  // namespace insitu
