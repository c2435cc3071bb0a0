#include "image/framebuffer.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "insitu/insitu.h"

namespace insitu {
namespace {

constexpr float infinitely_far = std::numeric_limits<float>::infinity();

uint64_t bytes_per_pixel(uint32_t channels) {
  uint64_t bytes = 4 * sizeof(float);
  if (channels & INSITU_CHANNEL_DEPTH) bytes += sizeof(float);
  if (channels & INSITU_CHANNEL_POSITION) bytes += 3 * sizeof(float);
  if (channels & INSITU_CHANNEL_NORMAL) bytes += 3 * sizeof(float);
  if (channels & INSITU_CHANNEL_ITEM) bytes += sizeof(uint64_t);
  return bytes;
}

}  // namespace

uint64_t FrameBuffer::bytes_for(uint32_t width, uint32_t height, uint32_t channels) {
  const uint64_t pixels = uint64_t{width} * height;
  const uint64_t each = bytes_per_pixel(channels);
  const uint64_t largest = std::numeric_limits<uint64_t>::max();
  return pixels > largest / each ? largest : pixels * each;
}

void FrameBuffer::allocate(uint32_t new_width, uint32_t new_height, uint32_t new_channels) {
  FrameBuffer fresh;
  fresh.width = new_width;
  fresh.height = new_height;
  fresh.channels = new_channels | INSITU_CHANNEL_COLOR;
  // Every vector is made at its final size with its background value: no slack, and each byte is touched once. No sum
  // below wraps around: a vector of 2^62 floats is refused before.
  const size_t pixels = fresh.pixel_count();
  if (pixels > fresh.color.max_size() / 4) throw std::length_error("frame buffer");
  fresh.color = std::vector<float>(4 * pixels, 0.0f);
  if (fresh.has(INSITU_CHANNEL_DEPTH)) fresh.depth = std::vector<float>(pixels, infinitely_far);
  if (fresh.has(INSITU_CHANNEL_POSITION)) fresh.position = std::vector<float>(3 * pixels, 0.0f);
  if (fresh.has(INSITU_CHANNEL_NORMAL)) fresh.normal = std::vector<float>(3 * pixels, 0.0f);
  if (fresh.has(INSITU_CHANNEL_ITEM)) fresh.item = std::vector<uint64_t>(pixels, no_item);
  *this = std::move(fresh);
}

void FrameBuffer::clear() {
  std::fill(color.begin(), color.end(), 0.0f);
  std::fill(depth.begin(), depth.end(), infinitely_far);
  std::fill(position.begin(), position.end(), 0.0f);
  std::fill(normal.begin(), normal.end(), 0.0f);
  std::fill(item.begin(), item.end(), no_item);
}

}  // namespace insitu
