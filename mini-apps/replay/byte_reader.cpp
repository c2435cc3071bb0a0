#include "byte_reader.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "input_error.h"
#include "input_file.h"

namespace replay {

void ByteReader::Close::operator()(gzFile_s* file) const { gzclose_r(file); }

ByteReader::ByteReader(std::string path) : path_(std::move(path)) {
  if (const std::string reason = reason_not_to_open(path_); !reason.empty()) throw InputError(path_, 0, reason);
  file_.reset(gzopen(path_.c_str(), "rb"));
  if (!file_) throw InputError(path_, 0, "cannot be opened: " + std::generic_category().message(errno));
  gzbuffer(file_.get(), 1u << 17);
  compressed_ = gzdirect(file_.get()) == 0;
  if (!compressed_) size_ = std::filesystem::file_size(path_);
}

std::string ByteReader::peek(std::size_t bytes) {
  std::string more(bytes - std::min(bytes, ahead_.size()), '\0');
  more.resize(read_some(more.data(), more.size()));
  offset_ -= more.size();
  ahead_ += more;
  return ahead_.substr(0, bytes);
}

std::size_t ByteReader::read_some(void* to, std::size_t bytes) {
  std::size_t done = 0;
  while (done < bytes) {
    const auto now = static_cast<unsigned>(std::min(bytes - done, chunk_bytes));
    const int got = gzread(file_.get(), static_cast<char*>(to) + done, now);
    if (got > 0) done += static_cast<std::size_t>(got);
    if (got < static_cast<int>(now)) {
      int code = Z_OK;
      const char* const text = gzerror(file_.get(), &code);
      if (code == Z_BUF_ERROR) fail("the compressed data are cut off");
      if (code != Z_OK && code != Z_STREAM_END) fail("the compressed data are damaged (" + std::string(text) + ")");
      break;
    }
  }
  offset_ += done;
  return done;
}

void ByteReader::read(void* to, std::size_t bytes, const char* what) {
  char* begin = static_cast<char*>(to);
  if (!ahead_.empty()) {
    const std::size_t taken = std::min(bytes, ahead_.size());
    std::memcpy(begin, ahead_.data(), taken);
    ahead_.erase(0, taken);
    offset_ += taken;
    begin += taken;
    bytes -= taken;
  }
  if (read_some(begin, bytes) < bytes) fail_at_end(what);
}

// Where the size is known a claim beyond it fails at once, not after all that is there has been read.
void ByteReader::check_there(std::uint64_t bytes, const char* what) {
  if (size_ && bytes > *size_ - std::min(offset_, *size_)) fail_at_end(what);
}

void ByteReader::skip(std::uint64_t bytes, const char* what) {
  check_there(bytes, what);
  std::vector<char> waste(static_cast<std::size_t>(std::min<std::uint64_t>(bytes, chunk_bytes)));
  while (bytes > 0) {
    const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, waste.size()));
    read(waste.data(), now, what);
    bytes -= now;
  }
}

bool ByteReader::at_end() { return peek(1).empty(); }

std::uint64_t ByteReader::size() {
  if (!size_) {
    const std::uint64_t here = offset_;
    std::vector<char> waste(chunk_bytes);
    offset_ += ahead_.size();
    ahead_.clear();
    while (read_some(waste.data(), waste.size()) > 0) {
    }
    size_ = offset_;
    rewind();
    skip(here, "what was there before");
  }
  return *size_;
}

void ByteReader::rewind() {
  gzrewind(file_.get());
  ahead_.clear();
  offset_ = 0;
}

void ByteReader::fail(const std::string& what) const {
  throw InputError(path_, 0, what + " (at byte " + std::to_string(offset_) + ")");
}

void ByteReader::fail_at_end(const char* what) const {
  throw InputError(path_, 0,
                   "the file ends too early, expected " + std::string(what) + " at byte " + std::to_string(offset_));
}

}  // namespace replay
