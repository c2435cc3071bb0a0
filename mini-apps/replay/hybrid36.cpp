#include "hybrid36.h"

#include <algorithm>

#include "numbers.h"

namespace replay {
namespace {

constexpr std::uint64_t base = 36;
constexpr std::size_t width = 5;
constexpr std::uint64_t first_letters = 100000;
constexpr std::uint64_t offset = 10 * base * base * base * base;  // "A0000" as a number of base 36
constexpr std::uint64_t per_case = 26 * base * base * base * base;

}  // namespace

std::string hybrid36(std::uint64_t number) {
  std::string text;
  if (number < first_letters) {
    text = std::to_string(number);
    text.insert(0, width - text.size(), ' ');
    return text;
  }
  number -= first_letters;
  const char a = number < per_case ? 'A' : 'a';
  number = number % per_case + offset;
  for (std::size_t i = 0; i < width; ++i, number /= base) {
    const auto digit = static_cast<char>(number % base);
    text += static_cast<char>(digit < 10 ? '0' + digit : a + digit - 10);
  }
  std::reverse(text.begin(), text.end());
  return text;
}

std::optional<std::int64_t> parse_hybrid36(std::string_view text) {
  text = trimmed(text);
  std::int64_t number = 0;
  if (parse_whole(text, number)) return number;
  if (text.size() != width || !starts_with_letter(text)) return std::nullopt;
  const bool small = text[0] >= 'a';
  std::uint64_t value = 0;
  for (const char c : text) {
    const char a = small ? 'a' : 'A';
    const bool letter = c >= a && c < a + 26;
    if (!letter && (c < '0' || c > '9')) return std::nullopt;
    value = value * base + static_cast<std::uint64_t>(letter ? c - a + 10 : c - '0');
  }
  return static_cast<std::int64_t>(value - offset + first_letters + (small ? per_case : 0));
}

}  // namespace replay
