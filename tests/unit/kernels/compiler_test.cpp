// What the kernels take for granted of the compiler. Built with the flags of libinsitu/cmake/policy.cmake.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace insitu::testing
