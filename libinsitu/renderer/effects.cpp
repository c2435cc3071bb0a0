#include "renderer/effects.h"

#include <cmath>

#include "core/error.h"

namespace insitu {

Effects make_effects(const insitu_effects& description) {
  const auto refuse = [](const char* text) {
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, std::string("effects: ") + text);
  };
  constexpr std::uint32_t known = INSITU_EFFECT_SHADOWS | INSITU_EFFECT_AMBIENT_OCCLUSION;
  if ((description.flags & ~known) != 0) refuse("unknown effect flags");
  Effects effects;
  effects.shadows = (description.flags & INSITU_EFFECT_SHADOWS) != 0;
  effects.ambient_occlusion = (description.flags & INSITU_EFFECT_AMBIENT_OCCLUSION) != 0;
  if (description.ao_samples != 0) effects.ao_samples = description.ao_samples;
  if (effects.ao_samples > 65536) refuse("more than 65536 ao_samples");
  effects.ao_radius = description.ao_radius;
  if (!(effects.ao_radius >= 0.0)) refuse("ao_radius is negative or not a number");
  effects.seed = description.seed;
  return effects;
}

EffectPlan plan_effects(const Effects& effects, const std::vector<Light>& lights, const Camera& camera,
                        const Bounds& bounds) {
  EffectPlan plan;
  for (const Light& light : lights) {
    if (!light.directional) {
      plan.ambient += light.radiance;
    } else if (light.radiance != glm::dvec3(0.0)) {
      plan.directional.push_back({light.radiance, direction_to(light, camera)});
    }
  }
  plan.shadows = effects.shadows && !plan.directional.empty();
  // Occlusion dims ambient light: without any it would change no pixel.
  if (effects.ambient_occlusion && plan.ambient != glm::dvec3(0.0)) plan.ao_samples = effects.ao_samples;
  plan.ao_radius = effects.ao_radius > 0.0 ? effects.ao_radius : 0.1 * bounds.diagonal();
  plan.seed = effects.seed;
  return plan;
}

}  // namespace insitu
