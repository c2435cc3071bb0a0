// Adaptive sampling: how far the displayed value of a pixel may be off, judged by its samples and those around it, and
// how many more it needs. docs/antialiasing.md derives the formulas.
#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <vector>

namespace insitu {

// The samples of one pixel, added up; colours are linear, premultiplied by alpha.
struct PixelSamples {
  std::uint32_t count = 0;
  glm::dvec4 sum{0.0};
  // Relative to the first sample: samples that agree have a variance of exactly 0.
  glm::dvec4 first{0.0};
  glm::dvec4 deviation{0.0};
  glm::dvec4 squares{0.0};

  void add(const glm::dvec4& color) {
    if (count++ == 0) first = color;
    sum += color;
    const glm::dvec4 off = color - first;
    deviation += off;
    squares += off * off;
  }
  glm::dvec4 mean() const { return sum * (1.0 / count); }
  // Sum of the squared distances from the mean.
  glm::dvec4 scatter() const;
};

struct SamplingRule {
  std::uint32_t max_samples;
  double pixel_error;  // tolerated standard error of a displayed value, 0..1
};

// Variance of a single sample in each pixel of a tile whose rows are `width` pixels long. A pixel's own samples count
// in full; what few samples cannot tell comes from the 3 x 3 pixels around it, and of these from the whole tile.
void estimate_variances(const std::vector<PixelSamples>& pixels, std::uint32_t width,
                        std::vector<glm::dvec4>& variances);

// sRGB value of a linear one, both 0..1 and clamped to it; the same on every machine. Off by less than 1e-5.
double displayed_value(double linear);

// Standard error of the displayed value of a pixel, the largest of its channels. `variance` is that of one sample.
double displayed_error(const PixelSamples& pixel, const glm::dvec4& variance);

// The number of samples that the pixel shall have before it is judged again; its count when it is done.
std::uint32_t next_count(const SamplingRule& rule, const PixelSamples& pixel, const glm::dvec4& variance);

}  // namespace insitu
