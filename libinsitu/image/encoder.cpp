#include "image/encoder.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <climits>
#include <memory>
#include <mutex>

#include "image/pixel_rows.h"
#include "image/png_text.h"

namespace insitu {
namespace {

// Creating its EXR writer makes OpenImageIO start as many OpenEXR threads, for good, as its attribute "exr_threads"
// says; -1 means none. Writers are made one at a time, so that none saves the -1 of another as the host's value.
std::unique_ptr<OIIO::ImageOutput> create_output(const char* format) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  int threads_of_host = 0;
  OIIO::getattribute("exr_threads", threads_of_host);
  OIIO::attribute("exr_threads", -1);
  std::unique_ptr<OIIO::ImageOutput> output;
  try {
    output = OIIO::ImageOutput::create(format);
  } catch (...) {
    OIIO::attribute("exr_threads", threads_of_host);
    throw;
  }
  OIIO::attribute("exr_threads", threads_of_host);
  if (output) output->threads(1);
  return output;
}

// Feeds rows to an encoder. `fill(first_row, row_count, destination)` packs rows in the file's own pixel layout, so
// that OpenImageIO has nothing to convert. `size_bound`: bytes that the file has at most; memory is reserved, not
// touched, and nothing is moved while the file grows.
template <class Fill>
Encoded encode(const char* format, const OIIO::ImageSpec& spec, size_t pixel_bytes, size_t size_bound, Fill&& fill) {
  Encoded result;
  result.bytes.reserve(size_bound);
  OIIO::Filesystem::IOVecOutput sink(result.bytes);
  const auto output = create_output(format);
  if (!output) {
    result.error = OIIO::geterror();
    if (result.error.empty()) result.error = "no encoder";
    return result;
  }
  const int rows_at_once = 64;  // a multiple of the 16 rows that EXR compresses together
  std::vector<unsigned char> rows(pixel_bytes * static_cast<size_t>(spec.width) *
                                  static_cast<size_t>(std::min(rows_at_once, spec.height)));

  bool good = output->set_ioproxy(&sink) && output->open(format, spec);
  for (int row = 0; good && row < spec.height; row += rows_at_once) {
    const int end = std::min(row + rows_at_once, spec.height);
    fill(static_cast<size_t>(row), static_cast<size_t>(end - row), rows.data());
    good = output->write_scanlines(row, end, 0, OIIO::TypeUnknown, rows.data());
  }
  good = output->close() && good;
  if (!good) {
    result.error = output->geterror();
    if (result.error.empty()) result.error = "encoding failed";
  }
  return result;
}

// -------------------------------------------------------------------------------------------------------- PNG --

Encoded encode_png(const FrameBuffer& frame, const ImageMetadata& metadata) {
  const int channels = png_channel_count(frame);
  OIIO::ImageSpec spec(static_cast<int>(frame.width), static_cast<int>(frame.height), channels, OIIO::TypeUInt8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("png:compressionLevel", 4);  // for noisy pictures half the time of the usual 6 and 3 % more bytes
  spec.attribute("oiio:UnassociatedAlpha", 1);
  const size_t pixel_bytes = static_cast<size_t>(channels);
  const size_t raw = frame.pixel_count() * pixel_bytes + frame.height;  // every row begins with a filter byte

  const auto fill = [&](size_t row, size_t row_count, unsigned char* out) {
    pack_png_rows(frame, channels, row, row_count, out);
  };
  Encoded result = encode("png", spec, pixel_bytes, raw + raw / 256 + 8192, fill);
  if (result.error.empty() && !insert_png_texts(result.bytes, metadata_texts(metadata))) result.error = "no PNG header";
  return result;
}

// -------------------------------------------------------------------------------------------------------- EXR --

void set_exr_attributes(OIIO::ImageSpec& spec, const ImageMetadata& metadata) {
  // Numbers are kept as numbers. OpenImageIO never forgets a text, so the texts here are few and always the same.
  const auto set_number = [&](const char* name, double value) { spec.attribute(name, OIIO::TypeDesc::DOUBLE, &value); };
  const auto set_vector = [&](const char* name, const std::array<double, 3>& value) {
    spec.attribute(name, OIIO::TypeDesc(OIIO::TypeDesc::DOUBLE, OIIO::TypeDesc::VEC3), value.data());
  };
  const CameraMetadata& camera = metadata.camera;
  spec.attribute("compression", "zip");
  spec.attribute("oiio:ColorSpace", "Linear");
  spec.attribute("DateTime", "");  // otherwise the clock is read: the same arguments are to give the same file
  if (!metadata.software.empty()) spec.attribute("Software", metadata.software);
  if (metadata.step <= INT_MAX) {
    spec.attribute("insitu:step", static_cast<int>(metadata.step));
  } else {
    spec.attribute("insitu:step", std::to_string(metadata.step));  // EXR has no longer integers
  }
  set_number("insitu:time", metadata.time);
  spec.attribute("insitu:camera.kind", camera_kind_name(camera.kind));
  set_vector("insitu:camera.eye", camera.eye);
  set_vector("insitu:camera.look_at", camera.look_at);
  set_vector("insitu:camera.up", camera.up);
  if (camera.kind == INSITU_CAMERA_ORTHOGRAPHIC) {
    set_number("insitu:camera.height", camera.height);
  } else {
    set_number("insitu:camera.fov_y_deg", camera.fov_y_deg);
  }
  spec.attribute("insitu:samples_per_pixel", static_cast<int>(std::min<uint32_t>(metadata.samples_per_pixel, INT_MAX)));
  if (metadata.max_samples_per_pixel != 0) {
    spec.attribute("insitu:max_samples_per_pixel",
                   static_cast<int>(std::min<uint32_t>(metadata.max_samples_per_pixel, INT_MAX)));
    set_number("insitu:pixel_error", metadata.pixel_error);
    set_number("insitu:mean_samples_per_pixel", metadata.mean_samples_per_pixel);
  }
  set_number("insitu:seconds.build", metadata.seconds_build);
  set_number("insitu:seconds.render", metadata.seconds_render);
}

Encoded encode_exr(const FrameBuffer& frame, const ImageMetadata& metadata) {
  const std::vector<ExrChannel> channels = exr_channels(frame);
  const size_t pixel_bytes = 4 * channels.size();
  OIIO::ImageSpec spec(static_cast<int>(frame.width), static_cast<int>(frame.height), static_cast<int>(channels.size()),
                       OIIO::TypeFloat);
  spec.channelnames.clear();
  for (const ExrChannel& channel : channels) {
    spec.channelnames.emplace_back(channel.name);
    spec.channelformats.push_back(channel.is_float ? OIIO::TypeFloat : OIIO::TypeUInt32);
  }
  spec.alpha_channel = 3;
  set_exr_attributes(spec, metadata);

  const auto fill = [&](size_t row, size_t row_count, unsigned char* out) {
    pack_exr_rows(channels, frame.width, row, row_count, out);
  };
  // Blocks that do not shrink are stored as they are, with at most 16 bytes of their own for each.
  const size_t bound = frame.pixel_count() * pixel_bytes + uint64_t{frame.height} * 16 + 8192;
  return encode("exr", spec, pixel_bytes, bound, fill);
}

}  // namespace
}  // namespace insitu

extern "C" void insitu_encode_image(const insitu::FrameBuffer& frame, const insitu::ImageMetadata& metadata,
                                    insitu::FileFormat format, insitu::Encoded& encoded) {
  encoded =
      format == insitu::FileFormat::png ? insitu::encode_png(frame, metadata) : insitu::encode_exr(frame, metadata);
}
