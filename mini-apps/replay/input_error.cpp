#include "input_error.h"

namespace replay {
namespace {

std::string message(const std::string& path, std::size_t line, std::string_view what) {
  std::string out = path;
  if (line > 0) {
    out += ':';
    out += std::to_string(line);
  }
  out += ": ";
  out += what;
  return out;
}

}  // namespace

InputError::InputError(const std::string& path, std::size_t line, std::string_view what)
    : std::runtime_error(message(path, line, what)) {}

std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::string out = "\"";
  for (const char c : text.substr(0, longest)) out += (c >= 32 && c < 127) ? c : '?';
  out += text.size() > longest ? "...\"" : "\"";
  return out;
}

}  // namespace replay
