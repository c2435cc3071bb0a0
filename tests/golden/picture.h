// 8-bit pictures: reading and writing PNG, and the one measure by which pictures are compared here.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace insitu::golden {

// RGBA, 4 bytes per pixel, rows from the top.
struct Picture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgba;
};

// Throws std::runtime_error.
Picture read_png(const std::string& path);
void write_png(const std::string& path, const Picture& picture);

// Linear premultiplied floats as a PNG holds them: sRGB, with the colour divided by alpha.
Picture encoded(std::uint32_t width, std::uint32_t height, const std::vector<float>& linear_rgba);

struct Difference {
  int max = 0;        // largest difference of a byte
  double mean = 0.0;  // mean difference of all bytes
  Picture image;      // differences, eight times as strong, opaque
};

// Of pictures of the same size; another size counts as 255 everywhere.
Difference difference(const Picture& a, const Picture& b);

}  // namespace insitu::golden
