#include "image_name.h"

#include <cmath>
#include <optional>
#include <string_view>

#include "input_error.h"
#include "numbers.h"
#include "options.h"

namespace replay {
namespace {

struct Key {
  std::string name;
  std::size_t width = 1;
};

constexpr std::int64_t widest = 20;

// "step:6", as between two braces; nothing when it is no key.
std::optional<Key> parse_key(std::string_view text) {
  const std::size_t colon = text.find(':');
  Key key{std::string(text.substr(0, colon)), 1};
  if (key.name != "step" && key.name != "angle") return std::nullopt;
  if (colon == std::string_view::npos) return key;
  std::int64_t width = 0;
  if (!parse_whole(text.substr(colon + 1), width) || width < 1 || width > widest) return std::nullopt;
  key.width = static_cast<std::size_t>(width);
  return key;
}

// Calls `literal` and `key` for the parts of a pattern. Throws UsageError.
template <class Literal, class OnKey>
void for_each_part(const std::string& pattern, Literal literal, OnKey on_key) {
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] != '{' && pattern[i] != '}') {
      literal(pattern[i]);
      continue;
    }
    const std::size_t end = pattern.find('}', i);
    std::optional<Key> key;
    if (pattern[i] == '{' && end != std::string::npos) {
      key = parse_key(std::string_view(pattern).substr(i + 1, end - i - 1));
    }
    if (!key) {
      throw UsageError("--out " + pattern + ": " +
                       quoted(pattern.substr(i, end == std::string::npos ? 1 : end - i + 1)) +
                       " is no key, expected {step}, {step:N}, {angle} or {angle:N} with N digits");
    }
    on_key(*key);
    i = end;
  }
}

bool has_key(const std::string& pattern, std::string_view name) {
  bool found = false;
  for_each_part(
      pattern, [](char) {}, [&](const Key& key) { found = found || key.name == name; });
  return found;
}

bool ends_with(std::string_view text, std::string_view ending) {
  return text.size() > ending.size() && equal_ignoring_case(text.substr(text.size() - ending.size()), ending);
}

}  // namespace

void check_image_pattern(const std::string& pattern) {
  has_key(pattern, "step");
  if (!ends_with(pattern, ".png") && !is_exr(pattern)) {
    throw UsageError("--out " + pattern + ": expected a name that ends in .png or .exr");
  }
}

bool has_step(const std::string& pattern) { return has_key(pattern, "step"); }
bool is_exr(const std::string& pattern) { return ends_with(pattern, ".exr"); }

std::string with_angle(const std::string& pattern) {
  if (has_key(pattern, "angle")) return pattern;
  const std::size_t ending = pattern.size() - 4;
  return pattern.substr(0, ending) + "_{angle:3}" + pattern.substr(ending);
}

std::string image_name(const std::string& pattern, std::uint64_t step, double angle_deg) {
  // Whole degrees in the name, and tenths where a turntable has more pictures than that.
  const auto tenths = static_cast<std::uint64_t>(std::llround(angle_deg * 10));
  std::string name;
  for_each_part(
      pattern, [&](char c) { name += c; },
      [&](const Key& key) {
        std::string digits = std::to_string(key.name == "step" ? step : tenths / 10);
        if (digits.size() < key.width) digits.insert(0, key.width - digits.size(), '0');
        if (key.name == "angle" && tenths % 10 != 0) digits.append(".").append(std::to_string(tenths % 10));
        name += digits;
      });
  return name;
}

}  // namespace replay
