// Finished images to files: PNG for looking at, EXR for computing with.
#pragma once

#include <cstdint>
#include <string>

#include "image/framebuffer.h"
#include "image/image_metadata.h"
#include "insitu/insitu.h"

namespace insitu {

struct WriteResult {
  insitu_status status = INSITU_OK;
  std::string message;      // empty when ok; otherwise names the file and the reason (without memory: the reason)
  uint64_t file_bytes = 0;  // size of the written file; 0 when not ok
};

// Writes `frame` to `path` in the format of its ending (any case):
//   .png  8 bits per channel, sRGB, colour not premultiplied; RGB where every pixel is opaque, otherwise RGBA
//   .exr  linear, zip: R G B A, and where the frame has them Z, P.X P.Y P.Z, N.X N.Y N.Z as 32 bit floats, and the item
//         index as uint32 `id` (low word), with `id.hi` (high word) only when an index needs it. Background: all ones.
// The file is complete or absent: it grows under a temporary name in the same folder and is renamed at the end. When
// anything fails the temporary file is gone and a file that `path` named before is as it was.
// Nothing is printed, and no process-wide setting differs afterwards. The first call loads the encoder, which takes a
// fifth of a second and starts four threads that sleep (see encoder.h); no other call starts any.
// Status: ok, invalid_argument (an empty frame), unsupported (another ending; no encoder), io, out_of_memory. Does not
// throw.
WriteResult write_image(const FrameBuffer& frame, const ImageMetadata& metadata, const std::string& path) noexcept;

}  // namespace insitu
