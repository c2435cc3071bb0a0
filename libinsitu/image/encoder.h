// A frame buffer as the bytes of a file, in a library of its own: libinsitu_image.
//
// Debian's OpenImageIO brings some 250 libraries into a process, four idle threads and 40 MB that are no file's. A rank
// that writes no image is spared them: libinsitu loads libinsitu_image when the first image is written, and so that
// none of its symbols meets one of the host's. encoder.cpp is the one file that knows OpenImageIO.
#pragma once

#include <string>
#include <vector>

#include "image/framebuffer.h"
#include "image/image_metadata.h"

namespace insitu {

enum class FileFormat { png, exr };

struct Encoded {
  std::vector<unsigned char> bytes;
  std::string error;  // empty when ok
};

using EncodeImage = void(const FrameBuffer& frame, const ImageMetadata& metadata, FileFormat format, Encoded& encoded);

// The encoder of libinsitu_image, loaded if it is not yet, for good. NULL when that fails; `error` then says why, and
// the next call tries again. Any number of threads may call at once.
EncodeImage* load_encoder(std::string& error);

}  // namespace insitu

// What libinsitu_image exports. Throws std::bad_alloc.
extern "C" __attribute__((visibility("default"))) void insitu_encode_image(const insitu::FrameBuffer& frame,
                                                                           const insitu::ImageMetadata& metadata,
                                                                           insitu::FileFormat format,
                                                                           insitu::Encoded& encoded);
