// The library computes in the default floating point environment, whatever the host has set (flush to zero, a rounding
// mode, trapping exceptions), and leaves the host's environment and its exception flags as they were.
#pragma once

#include <cfenv>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace insitu {

class FloatEnvironment {
 public:
#if defined(__SSE2__)
  FloatEnvironment() : saved_(_mm_getcsr()) { _mm_setcsr(default_mxcsr); }
  ~FloatEnvironment() { _mm_setcsr(saved_); }
#else
  FloatEnvironment() {
    std::fegetenv(&saved_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~FloatEnvironment() { std::fesetenv(&saved_); }
#endif
  FloatEnvironment(const FloatEnvironment&) = delete;
  FloatEnvironment& operator=(const FloatEnvironment&) = delete;

 private:
#if defined(__SSE2__)
  // All exceptions masked, round to nearest, denormals kept.
  static constexpr unsigned default_mxcsr = 0x1F80;
  unsigned saved_;
#else
  std::fenv_t saved_;
#endif
};

}  // namespace insitu
