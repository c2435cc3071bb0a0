// What every reader throws when a file cannot be read: "file:line: what is wrong, what was expected".
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace replay {

class InputError : public std::runtime_error {
 public:
  // Line 0 stands for the file as a whole.
  InputError(const std::string& path, std::size_t line, std::string_view what);
};

// Text of a file inside of a message: in quotes, shortened, and without bytes that would upset a terminal.
std::string quoted(std::string_view text);

}  // namespace replay
