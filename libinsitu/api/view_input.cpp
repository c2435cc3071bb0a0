// From insitu_view_desc, lights and backgrounds to a view.
#include <cmath>

#include "api/context.h"
#include "api/descriptor.h"

namespace insitu {

std::vector<Light> read_lights(const insitu_light* lights, std::uint64_t count) {
  if (count != 0 && lights == nullptr)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, "lights is NULL but their count is not 0");
  if (count > 1024) throw Error(INSITU_ERROR_INVALID_ARGUMENT, "more than 1024 lights");
  std::vector<Light> result;
  // The caller's structs may be shorter or longer than ours: they stand as far apart as the first one says.
  const auto* bytes = reinterpret_cast<const unsigned char*>(lights);
  std::uint32_t size = 0;
  if (count != 0) std::memcpy(&size, lights, sizeof size);
  for (std::uint64_t i = 0; i < count; ++i)
    result.push_back(make_light(copy_in(reinterpret_cast<const insitu_light*>(bytes + i * size), "insitu_light")));
  return result;
}

glm::dvec4 read_background(const double rgba[4]) {
  if (rgba == nullptr) throw Error(INSITU_ERROR_INVALID_ARGUMENT, "background is NULL");
  for (int c = 0; c < 4; ++c)
    if (!(rgba[c] >= 0.0 && std::isfinite(rgba[c])))
      throw Error(INSITU_ERROR_INVALID_ARGUMENT, "background is negative or not finite");
  if (rgba[3] > 1.0) throw Error(INSITU_ERROR_INVALID_ARGUMENT, "the background's opacity is above 1");
  return {rgba[0], rgba[1], rgba[2], rgba[3]};
}

ViewObject make_view(const insitu_view_desc* theirs) {
  ViewObject view;
  if (theirs == nullptr) return view;
  const insitu_view_desc desc = copy_in(theirs, "insitu_view_desc");
  if (desc.camera != nullptr) {
    view.camera = make_camera(copy_in(desc.camera, "insitu_camera"));
    view.to_be_fitted = false;
  }
  if (desc.effects != nullptr) view.effects = make_effects(copy_in(desc.effects, "insitu_effects"));
  view.lights = read_lights(desc.lights, desc.light_count);
  const double* back = desc.background;
  if (back[0] != 0.0 || back[1] != 0.0 || back[2] != 0.0 || back[3] != 0.0) view.background = read_background(back);
  return view;
}

}  // namespace insitu
