#include <hwy/targets.h>

#include <cstring>

#include "kernels/pkd_traverse.h"

namespace insitu::kernels {
namespace {

template <class Action>
void for_each_target(Action&& action) {
  const std::int64_t supported = hwy::SupportedTargets() & HWY_TARGETS;
  for (int bit = 0; bit < 62; ++bit)
    if ((supported >> bit & 1) != 0) action(std::int64_t{1} << bit);
}

}  // namespace

std::vector<const char*> simd_target_names() {
  std::vector<const char*> names;
  for_each_target([&](std::int64_t target) { names.push_back(hwy::TargetName(target)); });
  return names;
}

bool force_simd_target(const char* name) {
  hwy::SetSupportedTargetsForTest(0);
  bool found = name == nullptr;
  std::int64_t chosen = 0;
  for_each_target([&](std::int64_t target) {
    if (!found && std::strcmp(hwy::TargetName(target), name) == 0) {
      chosen = target;
      found = true;
    }
  });
  hwy::SetSupportedTargetsForTest(chosen);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  return found;
}

}  // namespace insitu::kernels
