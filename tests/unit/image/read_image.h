// Files as OpenImageIO reads them.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace insitu::testing {

struct ImageFile {
  OIIO::ImageSpec spec;
  std::vector<unsigned char> bytes;  // pixel after pixel in the file's own formats

  size_t pixel_bytes() const { return spec.pixel_bytes(true); }
  bool has(const std::string& channel) const { return spec.channelindex(channel) >= 0; }

  // Value of the named channel of a pixel, bit for bit; all channels before it have 4 bytes.
  template <class T>
  T value(size_t pixel, const std::string& channel) const {
    const int index = spec.channelindex(channel);
    if (index < 0) throw std::runtime_error("no channel " + channel);
    T value;
    std::memcpy(&value, bytes.data() + pixel * pixel_bytes() + static_cast<size_t>(index) * sizeof(T), sizeof(T));
    return value;
  }
};

// Reads without starting OpenEXR's threads, so that tests that count threads can come in any order.
inline ImageFile read_image(const std::string& path) {
  int threads = 0;
  OIIO::getattribute("exr_threads", threads);
  OIIO::attribute("exr_threads", -1);
  const auto input = OIIO::ImageInput::open(path);
  OIIO::attribute("exr_threads", threads);
  if (!input) throw std::runtime_error("cannot read " + path + ": " + OIIO::geterror());
  ImageFile file;
  file.spec = input->spec();
  file.bytes.resize(file.spec.image_bytes(true));
  if (!input->read_image(0, 0, 0, file.spec.nchannels, OIIO::TypeUnknown, file.bytes.data())) {
    throw std::runtime_error("cannot read " + path + ": " + input->geterror());
  }
  return file;
}

}  // namespace insitu::testing
