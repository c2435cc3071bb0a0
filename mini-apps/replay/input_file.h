// Why a file cannot be read at all.
#pragma once

#include <string>

namespace replay {

// Empty when `path` is a regular file with content.
std::string reason_not_to_open(const std::string& path);

}  // namespace replay
