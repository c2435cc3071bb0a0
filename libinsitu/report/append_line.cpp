#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "report/report.h"

namespace insitu {
namespace {

std::string reason_of(int error) {
  if (error == ENOENT) return "its folder does not exist";
  const char* text = strerrordesc_np(error);  // unlike strerror: thread-safe, and English in every locale
  return text ? text : "error " + std::to_string(error);
}

// 0, or the errno of the first failure; `text` becomes what is left. Usually one write: lines of several writers then
// do not mix.
int write_all(int file, std::string_view& text) {
  while (!text.empty()) {
    const ssize_t written = write(file, text.data(), text.size());
    if (written > 0) {
      text.remove_prefix(static_cast<size_t>(written));
    } else if (written == 0) {
      return ENOSPC;
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

// Past its limit on file sizes a process is not told by an error but killed by SIGXFSZ.
bool is_past_file_limit(uint64_t size) {
  rlimit limit;
  return getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && size > limit.rlim_cur;
}

int append_to(int file, std::string_view text) {
  struct stat before;
  if (fstat(file, &before) != 0) return errno;
  const bool regular = S_ISREG(before.st_mode);
  if (regular && is_past_file_limit(static_cast<uint64_t>(before.st_size) + text.size())) return EFBIG;
  std::string_view rest = text;
  const int error = write_all(file, rest);
  struct stat after;
  if (error != 0 && regular && fstat(file, &after) == 0) {
    // Half a line would spoil the next one. It is cut off, unless someone else wrote behind it.
    const bool alone = static_cast<size_t>(after.st_size - before.st_size) == text.size() - rest.size();
    if (alone && ftruncate(file, before.st_size) != 0) return error;
  }
  return error;
}

}  // namespace

AppendResult append_line(const std::string& path, std::string_view line) {
  const std::string text = std::string(line) + '\n';
  int error = 0;
  const int file = open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) {
    error = errno;
  } else {
    error = append_to(file, text);
    // A network file system may tell only here that the disk is full. After EINTR the file is closed all the same.
    if (close(file) != 0 && error == 0 && errno != EINTR) error = errno;
  }
  if (error == 0) return {};
  return {INSITU_ERROR_IO, "cannot append to \"" + path + "\": " + reason_of(error)};
}

}  // namespace insitu
