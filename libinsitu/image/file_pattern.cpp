#include "image/file_pattern.h"

#include <charconv>
#include <optional>

namespace insitu {
namespace {

constexpr int widest_step = 20;      // digits of 2^64 - 1
constexpr int widest_fraction = 17;  // digits past which a double has nothing to say near 1

// The number behind the colon of a key; nothing when it is no number from `smallest` to `largest`.
std::optional<int> parse_width(std::string_view text, int smallest, int largest) {
  int width = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), width);
  if (error != std::errc() || end != text.data() + text.size() || width < smallest || width > largest) return {};
  return width;
}

std::string step_text(uint64_t step, int width) {
  std::string digits = std::to_string(step);
  if (digits.size() < static_cast<size_t>(width)) digits.insert(0, static_cast<size_t>(width) - digits.size(), '0');
  return digits;
}

std::string time_text(double time, std::optional<int> fraction) {
  char buffer[400];  // 309 digits, point, 17 digits, sign
  char* const last = buffer + sizeof buffer;
  const auto end = fraction ? std::to_chars(buffer, last, time, std::chars_format::fixed, *fraction).ptr
                            : std::to_chars(buffer, last, time).ptr;
  return std::string(buffer, end);
}

// The text for what stands between two braces; nothing when it is no valid key.
std::optional<std::string> value_of(std::string_view key, uint64_t step, double time) {
  const size_t colon = key.find(':');
  const std::string_view name = key.substr(0, colon);
  const bool has_width = colon != std::string_view::npos;
  const std::string_view width_text = has_width ? key.substr(colon + 1) : std::string_view();
  if (name == "step") {
    const std::optional<int> width = has_width ? parse_width(width_text, 1, widest_step) : 1;
    if (width) return step_text(step, *width);
  } else if (name == "time") {
    const std::optional<int> fraction = has_width ? parse_width(width_text, 0, widest_fraction) : std::nullopt;
    if (fraction || !has_width) return time_text(time, fraction);
  }
  return {};
}

ExpandedPattern wrong(std::string_view pattern, const std::string& reason) {
  return {{},
          "file name pattern \"" + std::string(pattern) + "\": " + reason +
              "; valid are {step}, {step:N} with N from 1 to 20 digits, {time}, {time:N} with N from 0 to 17 digits " +
              "behind the point, and {{ or }} for a brace itself"};
}

}  // namespace

ExpandedPattern expand_pattern(std::string_view pattern, uint64_t step, double time) {
  ExpandedPattern result;
  for (size_t i = 0; i < pattern.size(); ++i) {
    const char c = pattern[i];
    if (c != '{' && c != '}') {
      result.text += c;
    } else if (i + 1 < pattern.size() && pattern[i + 1] == c) {
      result.text += c;
      ++i;
    } else if (c == '}') {
      return wrong(pattern, "a } stands alone");
    } else {
      const size_t end = pattern.find('}', i);
      if (end == std::string_view::npos) return wrong(pattern, "a { is not closed");
      const std::optional<std::string> value = value_of(pattern.substr(i + 1, end - i - 1), step, time);
      if (!value) return wrong(pattern, "unknown " + std::string(pattern.substr(i, end - i + 1)));
      result.text += *value;
      i = end;
    }
  }
  return result;
}

}  // namespace insitu
