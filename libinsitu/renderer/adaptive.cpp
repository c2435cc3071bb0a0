#include "renderer/adaptive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>

#include "scene/srgb.h"

namespace insitu {
namespace {

// What an estimate from a wider surrounding is worth beside own samples, in degrees of freedom: that of the tile beside
// those of 3 x 3 pixels, and theirs beside those of a pixel.
constexpr double tile_weight = 1.0;
constexpr double neighbourhood_weight = 8.0;
// From look to look, at most: the estimate that it follows may be one of few samples.
constexpr double most_growth = 8.0;

// Displayed values at linear = (i / intervals)^2, between which interpolation is good: the curve is close to a square
// root. Kept as float, which drops the last bits of pow, in which machines differ.
constexpr int intervals = 1024;

std::array<float, intervals + 2> make_curve() {
  std::array<float, intervals + 2> curve{};
  for (int i = 0; i <= intervals; ++i) {
    const double root = static_cast<double>(i) / intervals;
    curve[static_cast<std::size_t>(i)] = static_cast<float>(srgb_of_linear(root * root));
  }
  curve[intervals + 1] = curve[intervals];
  return curve;
}

// The larger of the two distances that one standard error down and up make: the curve is steep near black.
double displayed_distance(double mean, double error) {
  const double value = displayed_value(mean);
  return std::max(value - displayed_value(mean - error), displayed_value(mean + error) - value);
}

// What a tile or a neighbourhood adds up to.
struct Pool {
  glm::dvec4 scatter{0.0};
  double freedom = 0.0;
  void add(const PixelSamples& pixel) {
    scatter += pixel.scatter();
    freedom += pixel.count - 1.0;
  }
};

}  // namespace

glm::dvec4 PixelSamples::scatter() const {
  return glm::max(squares - deviation * deviation * (1.0 / count), glm::dvec4(0.0));
}

double displayed_value(double linear) {
  static const std::array<float, intervals + 2> curve = make_curve();
  const double clamped = linear > 0.0 ? (linear < 1.0 ? linear : 1.0) : 0.0;  // also for NaN
  const double at = std::sqrt(clamped) * intervals;
  const auto i = static_cast<std::size_t>(at);
  const double below = curve[i];
  return below + (at - static_cast<double>(i)) * (static_cast<double>(curve[i + 1]) - below);
}

void estimate_variances(const std::vector<PixelSamples>& pixels, std::uint32_t width,
                        std::vector<glm::dvec4>& variances) {
  Pool tile;
  for (const PixelSamples& pixel : pixels) tile.add(pixel);
  const glm::dvec4 tile_variance = tile.scatter / tile.freedom;
  const auto height = static_cast<std::uint32_t>(pixels.size() / width);
  variances.resize(pixels.size());
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      Pool around;
      for (std::uint32_t v = y - std::min(y, 1u); v <= std::min(y + 1, height - 1); ++v)
        for (std::uint32_t u = x - std::min(x, 1u); u <= std::min(x + 1, width - 1); ++u)
          around.add(pixels[std::size_t{v} * width + u]);
      const glm::dvec4 expected = (around.scatter + tile_weight * tile_variance) / (around.freedom + tile_weight);
      Pool own;
      own.add(pixels[std::size_t{y} * width + x]);
      variances[std::size_t{y} * width + x] =
          (own.scatter + neighbourhood_weight * expected) / (own.freedom + neighbourhood_weight);
    }
  }
}

double displayed_error(const PixelSamples& pixel, const glm::dvec4& variance) {
  const glm::dvec4 mean = pixel.mean();
  const auto error = [&](int c) { return std::sqrt(variance[c] / pixel.count); };
  double largest = error(3);  // opacity is shown as it is
  for (int c = 0; c < 3; ++c) largest = std::max(largest, displayed_distance(mean[c], error(c)));
  return largest;
}

std::uint32_t next_count(const SamplingRule& rule, const PixelSamples& pixel, const glm::dvec4& variance) {
  const std::uint32_t n = pixel.count;
  const double error = displayed_error(pixel, variance);
  if (!(error > rule.pixel_error) || n >= rule.max_samples) return n;
  // Errors fall with the square root of the number. Few looks: rays of one pixel that are traced together share most of
  // their way through the tree, and each look is a chance to stop because the samples happen to agree.
  const double ratio = error / rule.pixel_error;
  const std::uint32_t least = n + std::max(4u, n / 4);
  const double wanted = std::min(most_growth * n, std::ceil(n * ratio * ratio));
  return std::min(rule.max_samples, std::max(least, static_cast<std::uint32_t>(wanted)));
}

}  // namespace insitu
