#include "snapshot_radii.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace replay {
namespace {

struct Span {
  double lower = 0.0;
  double upper = 0.0;
};

// From the `cut`-th smallest coordinate along an axis to the `cut`-th largest; `x` is room to work in.
Span span_without(std::size_t cut, std::vector<double>& x) {
  const auto lower = x.begin() + static_cast<std::ptrdiff_t>(cut);
  const auto upper = x.end() - 1 - static_cast<std::ptrdiff_t>(cut);
  std::nth_element(x.begin(), lower, x.end());
  const double low = *lower;
  std::nth_element(x.begin(), upper, x.end());
  return {low, *upper};
}

// Half of the mean spacing in the box without the outer fraction 1 / `divisor` on each side; all of it for 0.
double half_spacing(const std::vector<double>& position, std::size_t divisor) {
  std::array<Span, 3> box;
  double volume = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> x;
    x.reserve(position.size() / 3);
    for (std::size_t i = axis; i < position.size(); i += 3) {
      if (std::isfinite(position[i])) x.push_back(position[i]);
    }
    if (x.empty()) return 0.0;
    box[axis] = span_without(divisor > 0 ? x.size() / divisor : 0, x);
    volume *= box[axis].upper - box[axis].lower;
  }
  std::size_t inside = 0;
  for (std::size_t i = 0; i < position.size(); i += 3) {
    bool in = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      in = in && position[i + axis] >= box[axis].lower && position[i + axis] <= box[axis].upper;
    }
    if (in) ++inside;
  }
  return inside > 0 && volume > 0.0 ? std::cbrt(volume / static_cast<double>(inside)) / 2 : 0.0;
}

}  // namespace

double common_radius(const Frame& frame) {
  return std::max(half_spacing(frame.position, 4), half_spacing(frame.position, 0) / 4);
}

void choose_snapshot_radii(Frame& frame) {
  if (frame.find("radius")) return;
  const double common = common_radius(frame);
  const Attribute* const mass = frame.find("mass");
  const Attribute* const density = frame.find("density");
  if (mass && density && mass->components == 1 && density->components == 1) {
    std::vector<float> radius(frame.count(), static_cast<float>(common));
    bool any = false;
    for (std::size_t i = 0; i < radius.size(); ++i) {
      const double spacing = std::cbrt(mass->at(i) / density->at(i));
      if (!std::isfinite(spacing) || spacing <= 0.0) continue;
      radius[i] = static_cast<float>(spacing / 2);
      any = true;
    }
    if (any) {
      frame.add("radius").scalars = std::move(radius);
      return;
    }
  }
  frame.radius_for_all = common;
}

}  // namespace replay
