#include "image/image_metadata.h"

#include <charconv>

namespace insitu {
namespace {

std::string vector_text(const std::array<double, 3>& v) {
  return number_text(v[0]) + ' ' + number_text(v[1]) + ' ' + number_text(v[2]);
}

}  // namespace

const char* camera_kind_name(uint32_t kind) {
  return kind == INSITU_CAMERA_ORTHOGRAPHIC ? "orthographic" : "perspective";
}

std::string number_text(double value) {
  char buffer[32];  // the longest shortest double has 24 characters
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return std::string(buffer, end);
}

std::vector<TextEntry> metadata_texts(const ImageMetadata& metadata) {
  const CameraMetadata& camera = metadata.camera;
  std::vector<TextEntry> texts;
  if (!metadata.software.empty()) texts.emplace_back("Software", metadata.software);
  texts.emplace_back("insitu:step", std::to_string(metadata.step));
  texts.emplace_back("insitu:time", number_text(metadata.time));
  texts.emplace_back("insitu:camera.kind", camera_kind_name(camera.kind));
  texts.emplace_back("insitu:camera.eye", vector_text(camera.eye));
  texts.emplace_back("insitu:camera.look_at", vector_text(camera.look_at));
  texts.emplace_back("insitu:camera.up", vector_text(camera.up));
  if (camera.kind == INSITU_CAMERA_ORTHOGRAPHIC) {
    texts.emplace_back("insitu:camera.height", number_text(camera.height));
  } else {
    texts.emplace_back("insitu:camera.fov_y_deg", number_text(camera.fov_y_deg));
  }
  texts.emplace_back("insitu:samples_per_pixel", std::to_string(metadata.samples_per_pixel));
  if (metadata.max_samples_per_pixel != 0) {
    texts.emplace_back("insitu:max_samples_per_pixel", std::to_string(metadata.max_samples_per_pixel));
    texts.emplace_back("insitu:pixel_error", number_text(metadata.pixel_error));
    texts.emplace_back("insitu:mean_samples_per_pixel", number_text(metadata.mean_samples_per_pixel));
  }
  texts.emplace_back("insitu:seconds.build", number_text(metadata.seconds_build));
  texts.emplace_back("insitu:seconds.render", number_text(metadata.seconds_render));
  return texts;
}

}  // namespace insitu
