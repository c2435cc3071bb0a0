// Rows of a frame buffer in the pixel layouts of the file formats.
#pragma once

#include <cstddef>
#include <vector>

#include "image/framebuffer.h"

namespace insitu {

// 3 where every pixel is opaque (alpha rounds to 255 of 255), otherwise 4.
int png_channel_count(const FrameBuffer& frame);

// 8 bits sRGB, colour not premultiplied; with 4 channels alpha follows. `out` has room for row_count * width pixels.
void pack_png_rows(const FrameBuffer& frame, int channels, size_t row, size_t row_count, unsigned char* out);

// A channel of 4 byte values, wherever the frame keeps them; the frame must outlive it.
struct ExrChannel {
  const char* name;
  bool is_float;  // otherwise uint32
  const unsigned char* first;
  size_t stride;  // bytes from pixel to pixel
};

// R G B A, then what the frame has of Z, P.X P.Y P.Z, N.X N.Y N.Z, id, id.hi. The last one is there only when an item
// index is 2^32 - 1 or more: that one would read as background if its low word stood alone.
std::vector<ExrChannel> exr_channels(const FrameBuffer& frame);

// Pixel after pixel, 4 bytes per channel.
void pack_exr_rows(const std::vector<ExrChannel>& channels, size_t width, size_t row, size_t row_count,
                   unsigned char* out);

}  // namespace insitu
