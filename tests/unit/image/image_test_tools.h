// What the tests of the image folder share.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "image/framebuffer.h"
#include "image/image_metadata.h"
#include "insitu/insitu.h"
#include "temporary_folder.h"

namespace insitu::testing {

constexpr uint32_t all_channels =
    INSITU_CHANNEL_COLOR | INSITU_CHANNEL_DEPTH | INSITU_CHANNEL_POSITION | INSITU_CHANNEL_NORMAL | INSITU_CHANNEL_ITEM;

inline std::vector<char> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Numbers that differ from pixel to pixel and channel to channel and do not compress well.
class Noise {
 public:
  explicit Noise(uint32_t seed) : state_(seed) {}
  float next() {  // 0..1
    state_ = state_ * 1664525u + 1013904223u;
    return static_cast<float>(state_ >> 8) / 16777216.0f;
  }

 private:
  uint32_t state_;
};

inline FrameBuffer noisy_frame(uint32_t width, uint32_t height, uint32_t channels, float alpha = 1.0f) {
  FrameBuffer frame;
  frame.allocate(width, height, channels);
  Noise noise(width * 7919 + height);
  for (size_t i = 0; i < frame.color.size(); i += 4) {
    for (size_t c = 0; c < 3; ++c) frame.color[i + c] = alpha * noise.next();
    frame.color[i + 3] = alpha;
  }
  for (float& value : frame.depth) value = 1000.0f * noise.next();
  for (float& value : frame.position) value = noise.next() - 0.5f;
  for (float& value : frame.normal) value = 2.0f * noise.next() - 1.0f;
  for (size_t i = 0; i < frame.item.size(); ++i) frame.item[i] = 1000 + 3 * i;
  return frame;
}

inline ImageMetadata some_metadata() {
  ImageMetadata metadata;
  metadata.step = 4200;
  metadata.time = 0.1;
  metadata.camera.eye = {1.5, -2.25, 1e-30};
  metadata.camera.look_at = {0.1, 0.2, 0.3};
  metadata.camera.up = {0, 1, 0};
  metadata.camera.fov_y_deg = 35.5;
  metadata.samples_per_pixel = 16;
  metadata.seconds_build = 0.0625;
  metadata.seconds_render = 1.75;
  metadata.software = "insitu 0.1.0";
  return metadata;
}

}  // namespace insitu::testing
