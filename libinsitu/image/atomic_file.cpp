#include "image/atomic_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace insitu {
namespace {

std::string folder_of(const std::string& path) {
  const size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return path.substr(0, slash == 0 ? 1 : slash);
}

FileResult failure(const std::string& path, const std::string& reason) {
  return {INSITU_ERROR_IO, "cannot write \"" + path + "\": " + reason};
}

std::string reason_of(const std::string& path, int error) {
  const std::string folder = folder_of(path);
  if (error == ENOENT) return "the folder \"" + folder + "\" does not exist";
  if (error == ENOTDIR) return "the folder \"" + folder + "\" is not a folder";
  const char* text = strerrordesc_np(error);  // unlike strerror: thread-safe, and English in every locale
  return text ? text : "error " + std::to_string(error);
}

// The reason why the entry that `path` names must not be replaced; empty when there is none.
std::string reason_to_keep(const std::string& path) {
  struct stat info;
  if (lstat(path.c_str(), &info) != 0) return {};
  if (S_ISDIR(info.st_mode)) return "it is a folder";
  if (S_ISLNK(info.st_mode)) return {};
  if (!S_ISREG(info.st_mode)) return "it is not a regular file";
  // A rename asks only for the permission to write to the folder; a file that was made read-only is meant to stay.
  if (faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0) return reason_of(path, errno);
  return {};
}

// Opens a new file in the folder of `path`. The name of the temporary file does not grow with that of the target, so
// that long names stay possible. It may be taken: left by a run that was killed, or by a process with the same number
// on another node.
int open_temporary(const std::string& path, std::string& name) {
  static std::atomic<unsigned> counter{0};
  const size_t slash = path.rfind('/');
  const std::string prefix = slash == std::string::npos ? std::string() : path.substr(0, slash + 1);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    name = prefix + ".insitu-" + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".tmp";
    const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0 || (errno != EEXIST && errno != EINTR)) return file;
  }
  return -1;
}

// 0, or the errno of the first failure.
int write_all(int file, std::span<const unsigned char> bytes) {
  // Past its limit on file sizes a process is not told by an error but killed by SIGXFSZ.
  rlimit limit;
  if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && bytes.size() > limit.rlim_cur) {
    return EFBIG;
  }
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written > 0) {
      bytes = bytes.subspan(static_cast<size_t>(written));
    } else if (written == 0) {
      return ENOSPC;
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

}  // namespace

FileResult write_file_atomically(const std::string& path, std::span<const unsigned char> bytes) {
  if (const std::string reason = reason_to_keep(path); !reason.empty()) return failure(path, reason);

  std::string temporary;
  const int file = open_temporary(path, temporary);
  if (file < 0) return failure(path, reason_of(path, errno));
  int error = write_all(file, bytes);
  // A network file system may tell only here that the disk is full. After EINTR the file is closed all the same.
  if (close(file) != 0 && error == 0 && errno != EINTR) error = errno;
  if (error == 0 && rename(temporary.c_str(), path.c_str()) != 0) error = errno;
  if (error == 0) return {};

  unlink(temporary.c_str());
  return failure(path, reason_of(path, error));
}

}  // namespace insitu
