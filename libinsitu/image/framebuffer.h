// The pixels of one image, channel by channel, as the renderer fills them and the writer stores them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace insitu {

// Rows from the top, pixels from the left. A channel that was not asked for holds no memory.
struct FrameBuffer {
  uint32_t width = 0;     // pixels
  uint32_t height = 0;    // pixels
  uint32_t channels = 0;  // INSITU_CHANNEL_* bits; colour is always among them

  std::vector<float> color;     // 4 per pixel: linear RGB premultiplied by alpha, alpha
  std::vector<float> depth;     // 1 per pixel: distance along the ray from the eye; +inf = background
  std::vector<float> position;  // 3 per pixel: world position of the hit; 0 = background
  std::vector<float> normal;    // 3 per pixel: unit normal towards the viewer; 0 = background
  std::vector<uint64_t> item;   // 1 per pixel: item index; no_item = background

  static constexpr uint64_t no_item = ~uint64_t{0};

  uint64_t pixel_count() const { return uint64_t{width} * height; }
  bool has(uint32_t channel) const { return (channels & channel) == channel; }

  // Bytes that allocate() with the same arguments would hold; the largest uint64_t when the sum does not fit into one.
  static uint64_t bytes_for(uint32_t width, uint32_t height, uint32_t channels);

  // Gives every asked-for channel its memory, exactly bytes_for() of it, and clears it. On std::bad_alloc or
  // std::length_error the buffer is as it was.
  void allocate(uint32_t width, uint32_t height, uint32_t channels);

  // Sets every pixel to the background: transparent black, infinitely far, nothing hit.
  void clear();
};

}  // namespace insitu
