// Runs something once for every SIMD target of the machine, and leaves the choice to the library again.
#pragma once

#include <gtest/gtest.h>

#include "kernels/pkd_traverse.h"

namespace insitu::testing {

template <class Action>
void for_each_simd_target(Action&& action) {
  struct Restore {
    ~Restore() { kernels::force_simd_target(nullptr); }
  } restore;
  for (const char* name : kernels::simd_target_names()) {
    ASSERT_TRUE(kernels::force_simd_target(name)) << name;
    action(name);
  }
}

}  // namespace insitu::testing
