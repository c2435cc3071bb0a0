// The sRGB transfer function (IEC 61966-2-1) in the direction that image files need.
#pragma once

#include <cstdint>

namespace insitu {

// The byte whose sRGB value is nearest to `linear`: 0 below 0 and for NaN, 255 above 1. Where two bytes are equally
// near, the larger one. The same on every machine: decided by comparison with constants, without calls of pow.
uint8_t linear_to_srgb8(float linear);

// The byte nearest to a value that stays linear, such as alpha: 0 below 0 and for NaN, 255 above 1.
uint8_t linear_to_unorm8(float value);

}  // namespace insitu
