#include "image/pixel_rows.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <initializer_list>

#include "image/srgb.h"
#include "insitu/insitu.h"

namespace insitu {

int png_channel_count(const FrameBuffer& frame) {
  for (size_t i = 3; i < frame.color.size(); i += 4) {
    if (linear_to_unorm8(frame.color[i]) != 255) return 4;
  }
  return 3;
}

void pack_png_rows(const FrameBuffer& frame, int channels, size_t row, size_t row_count, unsigned char* out) {
  const float* pixel = frame.color.data() + row * frame.width * 4;
  const float* const end = pixel + row_count * frame.width * 4;
  for (; pixel != end; pixel += 4) {
    const float alpha = pixel[3];
    const float divisor = alpha > 0.0f && alpha < 1.0f ? alpha : 1.0f;
    for (int c = 0; c < 3; ++c) *out++ = linear_to_srgb8(pixel[c] / divisor);
    if (channels == 4) *out++ = linear_to_unorm8(alpha);
  }
}

namespace {

bool needs_high_words(const std::vector<uint64_t>& items) {
  return std::any_of(items.begin(), items.end(),
                     [](uint64_t item) { return item != FrameBuffer::no_item && item >= 0xffffffffu; });
}

}  // namespace

std::vector<ExrChannel> exr_channels(const FrameBuffer& frame) {
  std::vector<ExrChannel> channels;
  const auto add_floats = [&](const std::vector<float>& values, std::initializer_list<const char*> names) {
    const auto* first = reinterpret_cast<const unsigned char*>(values.data());
    for (const char* name : names) {
      channels.push_back({name, true, first, names.size() * sizeof(float)});
      first += sizeof(float);
    }
  };
  add_floats(frame.color, {"R", "G", "B", "A"});
  if (frame.has(INSITU_CHANNEL_DEPTH)) add_floats(frame.depth, {"Z"});
  if (frame.has(INSITU_CHANNEL_POSITION)) add_floats(frame.position, {"P.X", "P.Y", "P.Z"});
  if (frame.has(INSITU_CHANNEL_NORMAL)) add_floats(frame.normal, {"N.X", "N.Y", "N.Z"});
  if (frame.has(INSITU_CHANNEL_ITEM)) {
    const auto* words = reinterpret_cast<const unsigned char*>(frame.item.data());
    const size_t low = std::endian::native == std::endian::little ? 0 : 4;
    channels.push_back({"id", false, words + low, sizeof(uint64_t)});
    if (needs_high_words(frame.item)) channels.push_back({"id.hi", false, words + 4 - low, sizeof(uint64_t)});
  }
  return channels;
}

void pack_exr_rows(const std::vector<ExrChannel>& channels, size_t width, size_t row, size_t row_count,
                   unsigned char* out) {
  const size_t pixel_bytes = 4 * channels.size();
  for (size_t c = 0; c < channels.size(); ++c) {
    const unsigned char* in = channels[c].first + row * width * channels[c].stride;
    for (size_t i = 0; i < row_count * width; ++i, in += channels[c].stride) {
      std::memcpy(out + i * pixel_bytes + 4 * c, in, 4);
    }
  }
}

}  // namespace insitu
