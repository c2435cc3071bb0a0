#include "geometry/geometry_info.h"

#include "kernels/pkd_traverse.h"

namespace insitu {

std::string simd_targets_text() {
  std::string text;
  for (const char* name : kernels::simd_target_names()) text.append(" ").append(name);
  return text;
}

}  // namespace insitu
