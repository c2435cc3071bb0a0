// What the kernels behind the geometries can do on this machine.
#pragma once

#include <string>

namespace insitu {

// " AVX3 AVX2 SSE4": every compiled SIMD target that this machine can run, best first, each with a blank before it.
std::string simd_targets_text();

}  // namespace insitu
