#include "scene/light.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/error.h"

namespace insitu {

Light make_light(const insitu_light& description) {
  const auto refuse = [](const char* text) {
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, std::string("light: ") + text);
  };
  if (description.kind != INSITU_LIGHT_AMBIENT && description.kind != INSITU_LIGHT_DIRECTIONAL)
    refuse("kind is neither INSITU_LIGHT_AMBIENT nor INSITU_LIGHT_DIRECTIONAL");
  if ((description.flags & ~std::uint32_t{INSITU_LIGHT_IN_CAMERA_SPACE}) != 0) refuse("unknown flags");
  Light light;
  light.directional = description.kind == INSITU_LIGHT_DIRECTIONAL;
  light.in_camera_space = (description.flags & INSITU_LIGHT_IN_CAMERA_SPACE) != 0;
  const glm::dvec3 color(description.color[0], description.color[1], description.color[2]);
  const double intensity = description.intensity == 0.0 ? 1.0 : description.intensity;
  light.radiance = (color == glm::dvec3(0.0) ? glm::dvec3(1.0) : color) * intensity;
  for (int c = 0; c < 3; ++c)
    if (!(light.radiance[c] >= 0.0 && std::isfinite(light.radiance[c])))
      refuse("colour or intensity is negative or not finite");
  if (light.directional) {
    const glm::dvec3 along(description.direction[0], description.direction[1], description.direction[2]);
    // Scaled first: components may be as small or large as doubles get.
    const double largest = std::max({std::abs(along.x), std::abs(along.y), std::abs(along.z)});
    if (!(largest > 0.0 && std::isfinite(along.x) && std::isfinite(along.y) && std::isfinite(along.z)))
      refuse("a directional light needs a direction");
    light.towards = -glm::normalize(along / largest);
  }
  return light;
}

std::vector<Light> default_lights() {
  Light ambient;
  ambient.radiance = glm::dvec3(0.45);
  Light key;
  key.radiance = glm::dvec3(0.65);
  key.directional = true;
  key.in_camera_space = true;
  key.towards = glm::normalize(glm::dvec3(-0.5, 0.8, -1.0));
  return {ambient, key};
}

glm::dvec3 direction_to(const Light& light, const Camera& camera) {
  if (!light.in_camera_space) return light.towards;
  return light.towards.x * camera.right() + light.towards.y * camera.true_up() + light.towards.z * camera.forward();
}

}  // namespace insitu
