// What an image file says about its own making.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "insitu/insitu.h"

namespace insitu {

// The camera as it stood when the image was rendered, defaults filled in.
struct CameraMetadata {
  uint32_t kind = INSITU_CAMERA_PERSPECTIVE;  // INSITU_CAMERA_*
  std::array<double, 3> eye{};                // simulation's length unit
  std::array<double, 3> look_at{};            // simulation's length unit
  std::array<double, 3> up{};
  double fov_y_deg = 0;  // perspective only
  double height = 0;     // orthographic only; simulation's length unit
};

struct ImageMetadata {
  uint64_t step = 0;
  double time = 0;  // simulation's time unit
  CameraMetadata camera;
  uint32_t samples_per_pixel = 0;      // of an adaptive image the least
  uint32_t max_samples_per_pixel = 0;  // 0: not adaptive, and the next two say nothing
  double pixel_error = 0;              // tolerated standard error, of displayed values of 0..1
  double mean_samples_per_pixel = 0;
  double seconds_build = 0;   // wall time
  double seconds_render = 0;  // wall time
  std::string software;       // name and version of the library
};

// "perspective" or "orthographic".
const char* camera_kind_name(uint32_t kind);

// The shortest text that reads back as the same number: 0.1, 1e-05, nan. The point is a point in every locale.
std::string number_text(double value);

using TextEntry = std::pair<std::string, std::string>;  // key, value

// Every member as text, in a fixed order: "Software", "insitu:step", "insitu:time", "insitu:camera.kind",
// "insitu:camera.eye" (three numbers and blanks between them) ... For formats whose metadata are texts.
std::vector<TextEntry> metadata_texts(const ImageMetadata& metadata);

}  // namespace insitu
