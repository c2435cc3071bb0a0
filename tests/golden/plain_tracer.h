// A ray tracer of its own, in plain C++ and by brute force, written from what the documentation of the library says a
// picture is. It knows spheres in colours and opacities by category, a fixed camera, ambient and directional lights,
// and shadows.
#pragma once

#include <vector>

#include "golden_scene.h"

namespace insitu::golden {

// 4 floats per pixel, linear; the background is opaque.
std::vector<float> trace_plainly(const Scene& scene);

}  // namespace insitu::golden
