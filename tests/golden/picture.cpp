#include "picture.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

namespace insitu::golden {

Picture read_png(const std::string& path) {
  // Colours as they stand in the file: not multiplied by alpha, and rounded once more.
  OIIO::ImageSpec as_stored;
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path, &as_stored);
  if (!input) throw std::runtime_error(path + ": " + OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  Picture picture;
  picture.width = static_cast<std::uint32_t>(spec.width);
  picture.height = static_cast<std::uint32_t>(spec.height);
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  std::vector<std::uint8_t> bytes(pixels * channels);
  if (channels < 3 || !input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, bytes.data()))
    throw std::runtime_error(path + ": " + input->geterror());
  picture.rgba.assign(4 * pixels, 255);
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t c = 0; c < std::min<std::size_t>(channels, 4); ++c)
      picture.rgba[4 * i + c] = bytes[channels * i + c];
  return picture;
}

void write_png(const std::string& path, const Picture& picture) {
  // References are kept small: no alpha where all is opaque.
  bool opaque = true;
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) opaque = opaque && picture.rgba[i] == 255;
  OIIO::ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height), opaque ? 3 : 4,
                       OIIO::TypeDesc::UINT8);
  spec.attribute("png:compressionLevel", 9);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(path);
  if (!output || !output->open(path, spec) || !output->write_image(OIIO::TypeDesc::UINT8, picture.rgba.data(), 4) ||
      !output->close())
    throw std::runtime_error(path + ": cannot be written");
}

Picture encoded(std::uint32_t width, std::uint32_t height, const std::vector<float>& linear_rgba) {
  Picture picture;
  picture.width = width;
  picture.height = height;
  for (std::size_t i = 0; i < linear_rgba.size(); i += 4) {
    const double alpha = std::clamp(static_cast<double>(linear_rgba[i + 3]), 0.0, 1.0);
    for (std::size_t c = 0; c < 3; ++c) {
      const double linear = alpha > 0.0 ? std::clamp(linear_rgba[i + c] / alpha, 0.0, 1.0) : 0.0;
      const double srgb = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
      picture.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0 * srgb)));
    }
    picture.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0 * alpha)));
  }
  return picture;
}

Difference difference(const Picture& a, const Picture& b) {
  Difference result;
  result.image = a;
  if (a.width != b.width || a.height != b.height || a.rgba.size() != b.rgba.size()) {
    result.max = 255;
    result.mean = 255.0;
    return result;
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    const int off = std::abs(int{a.rgba[i]} - int{b.rgba[i]});
    result.max = std::max(result.max, off);
    sum += off;
    result.image.rgba[i] = i % 4 == 3 ? 255 : static_cast<std::uint8_t>(std::min(255, 8 * off));
  }
  result.mean = a.rgba.empty() ? 0.0 : sum / static_cast<double>(a.rgba.size());
  return result;
}

}  // namespace insitu::golden
