// The sRGB transfer function (IEC 61966-2-1) in double precision, both ways: for tables that are made once. Pixels have
// one of their own, image/srgb.h.
#pragma once

#include <cmath>

namespace insitu {

// Both take and give values of 0 to 1.
inline double linear_of_srgb(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}
inline double srgb_of_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

}  // namespace insitu
