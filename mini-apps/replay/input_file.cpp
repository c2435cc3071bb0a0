#include "input_file.h"

#include <filesystem>

namespace replay {

std::string reason_not_to_open(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) return "there is no such file";
  if (error) return "cannot be opened: " + error.message();
  if (std::filesystem::is_directory(status)) return "is a folder, expected a file";
  if (!std::filesystem::is_regular_file(status)) return "is not a regular file";
  if (std::filesystem::file_size(path, error) == 0) return "is empty";
  return {};
}

}  // namespace replay
