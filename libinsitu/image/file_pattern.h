// File names that carry the step: "frame_{step:6}.png" -> "frame_000042.png".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace insitu {

struct ExpandedPattern {
  std::string text;   // the file name; empty when the pattern is wrong
  std::string error;  // empty when the pattern is right; otherwise a sentence naming the pattern and the valid keys

  bool ok() const { return error.empty(); }
};

// Keys: {step}, {step:N} (zero padded to at least N digits, N from 1 to 20), {time}, {time:N} (N digits behind the
// point, 0 to 17; {time} alone is the shortest text that reads back as the same number). {{ and }} stand for the braces
// themselves. Independent of the locale.
ExpandedPattern expand_pattern(std::string_view pattern, uint64_t step, double time);

}  // namespace insitu
