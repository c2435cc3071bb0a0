// The effect plan: which passes an image needs. A pass that is not in the plan costs nothing: no ray, no byte.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "insitu/insitu.h"
#include "scene/camera.h"
#include "scene/light.h"

namespace insitu {

struct Effects {
  bool shadows = false;
  bool ambient_occlusion = false;
  std::uint32_t ao_samples = 8;
  double ao_radius = 0.0;  // 0: a tenth of the scene's diagonal
  std::uint32_t seed = 0;
};

// Throws Error(invalid_argument).
Effects make_effects(const insitu_effects& description);

struct PlannedLight {
  glm::dvec3 radiance;
  glm::dvec3 towards;
};

struct EffectPlan {
  glm::dvec3 ambient{0.0};                // sum of the ambient lights
  std::vector<PlannedLight> directional;  // lights that can reach a surface
  bool shadows = false;                   // asked for, and there is a light to cast them
  std::uint32_t ao_samples = 0;           // per camera ray that hits; 0 = none
  double ao_radius = 0.0;
  std::uint32_t seed = 0;
};

EffectPlan plan_effects(const Effects& effects, const std::vector<Light>& lights, const Camera& camera,
                        const Bounds& bounds);

}  // namespace insitu
