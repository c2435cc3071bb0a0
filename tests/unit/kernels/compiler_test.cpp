// What the kernels take for granted of the compiler. Built with the flags of libinsitu/cmake/policy.cmake.
#include <gtest/gtest.h>

#include <cstring>

#include "kernels/prefetch.h"

namespace insitu::testing {
namespace {

// A number as the sum of two floats, next to what else is made of it in the same loop: as MakeLeafFrame does it.
struct Split {
  double whole[3];
  float head[3];
  float tail[3];
  float direction[3];
};

[[gnu::noinline]] Split split(const double* origin, const double* direction, double t) {
  Split result;
  for (int c = 0; c < 3; ++c) {
    result.whole[c] = origin[c] + t * direction[c];
    result.head[c] = static_cast<float>(result.whole[c]);
    result.tail[c] = static_cast<float>(result.whole[c] - static_cast<double>(result.head[c]));
    result.direction[c] = static_cast<float>(direction[c]);
  }
  return result;
}

TEST(Compiler, RoundsToFloatWhenTold) {
  const double origin[] = {9999.98, 9999.12, 9998.68};
  const double direction[] = {0.0978, 0.662, 0.743};
  for (const double t : {0.0, 0.3, 0.7}) {
    const Split numbers = split(origin, direction, t);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NE(numbers.tail[c], 0.0f) << "component " << c;
      const double sum = static_cast<double>(numbers.head[c]) + static_cast<double>(numbers.tail[c]);
      EXPECT_NEAR(sum, numbers.whole[c], 1e-10) << "component " << c;
    }
  }
}

[[gnu::noinline]] void ask_for(const void* memory, std::size_t bytes) { kernels::prefetch_bytes(memory, bytes); }
[[gnu::noinline]] void ask_through_call(const void* memory) { ask_for(memory, 640); }

#if defined(__x86_64__) && defined(__OPTIMIZE__)
// To GCC 12 a function that does nothing but prefetch has no effect: where a call of it was dropped, nothing but the
// return is left of the caller.
TEST(Compiler, KeepsCallsThatOnlyPrefetch) {
  constexpr unsigned char endbr64[] = {0xf3, 0x0f, 0x1e, 0xfa};
  constexpr unsigned char ret = 0xc3;
  const auto* code = reinterpret_cast<const unsigned char*>(&ask_through_call);
  if (std::memcmp(code, endbr64, sizeof endbr64) == 0) code += sizeof endbr64;
  EXPECT_NE(*code, ret);
  ask_through_call(&code);
}
#endif

}  // namespace
}  // namespace insitu::testing
