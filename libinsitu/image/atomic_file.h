// A whole file or none.
#pragma once

#include <span>
#include <string>

#include "insitu/insitu.h"

namespace insitu {

struct FileResult {
  insitu_status status = INSITU_OK;
  std::string message;  // empty when ok; otherwise one sentence that names the file and the reason
};

// Writes `bytes` under a temporary name in the folder of `path` and renames it. On failure the temporary file is
// removed, and what `path` named before is untouched. A symbolic link at `path` is replaced, not followed; folders,
// devices and files without write permission are refused. Status: ok, io.
FileResult write_file_atomically(const std::string& path, std::span<const unsigned char> bytes);

}  // namespace insitu
