#include "image/image_writer.h"

#include <algorithm>
#include <climits>
#include <new>
#include <string_view>

#include "image/atomic_file.h"
#include "image/encoder.h"

namespace insitu {
namespace {

constexpr uint32_t largest_side_of_png = 1000000;  // libpng's own limit; past it libpng prints to stderr

bool is_consistent(const FrameBuffer& frame) {
  const auto fits = [&](uint32_t channel, size_t size, size_t per_pixel) {
    return !frame.has(channel) || size == per_pixel * frame.pixel_count();
  };
  return frame.width > 0 && frame.height > 0 && frame.color.size() == 4 * frame.pixel_count() &&
         fits(INSITU_CHANNEL_DEPTH, frame.depth.size(), 1) && fits(INSITU_CHANNEL_POSITION, frame.position.size(), 3) &&
         fits(INSITU_CHANNEL_NORMAL, frame.normal.size(), 3) && fits(INSITU_CHANNEL_ITEM, frame.item.size(), 1);
}

bool has_ending(std::string_view path, std::string_view ending) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; };
  return path.size() > ending.size() &&
         std::equal(ending.begin(), ending.end(), path.end() - static_cast<std::ptrdiff_t>(ending.size()),
                    [&](char wanted, char c) { return wanted == lower(c); });
}

WriteResult failure(insitu_status status, const std::string& path, const std::string& reason) {
  return {status, "cannot write \"" + path + "\": " + reason, 0};
}

WriteResult write_checked(const FrameBuffer& frame, const ImageMetadata& metadata, const std::string& path) {
  const bool png = has_ending(path, ".png");
  if (!png && !has_ending(path, ".exr")) {
    return failure(INSITU_ERROR_UNSUPPORTED, path, "the name has to end in .png or .exr");
  }
  if (!is_consistent(frame)) return failure(INSITU_ERROR_INVALID_ARGUMENT, path, "the image has no pixels");
  const uint32_t largest_side = png ? largest_side_of_png : INT_MAX;
  if (frame.width > largest_side || frame.height > largest_side) {
    return failure(INSITU_ERROR_UNSUPPORTED, path,
                   "the format has at most " + std::to_string(largest_side) + " pixels per side");
  }
  // Files are encoded in memory and written by write_file_atomically: a full disk is then noticed for certain, and told
  // with the reason that the system gives.
  Encoded encoded;
  EncodeImage* const encode = load_encoder(encoded.error);
  if (encode == nullptr) return failure(INSITU_ERROR_UNSUPPORTED, path, encoded.error);
  encode(frame, metadata, png ? FileFormat::png : FileFormat::exr, encoded);
  if (!encoded.error.empty()) return failure(INSITU_ERROR_IO, path, encoded.error);
  const FileResult file = write_file_atomically(path, encoded.bytes);
  if (file.status != INSITU_OK) return {file.status, file.message, 0};
  return {INSITU_OK, {}, encoded.bytes.size()};
}

}  // namespace

WriteResult write_image(const FrameBuffer& frame, const ImageMetadata& metadata, const std::string& path) noexcept {
  try {
    return write_checked(frame, metadata, path);
  } catch (const std::bad_alloc&) {
    return {INSITU_ERROR_OUT_OF_MEMORY, "out of memory", 0};  // short enough for a string without memory of its own
  } catch (...) {
    return {INSITU_ERROR_INTERNAL, "internal error", 0};
  }
}

}  // namespace insitu
