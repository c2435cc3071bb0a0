// Reads a binary file, compressed by gzip or not, in either byte order, and believes no size that the file states: what
// is read grows with what is there.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

struct gzFile_s;

namespace replay {

template <class T>
T byte_swapped(T value) {
  std::array<unsigned char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

class ByteReader {
 public:
  // Throws InputError when the file cannot be opened, is a folder or is empty.
  explicit ByteReader(std::string path);

  // For all numbers that are read from here on.
  void set_order(std::endian order) { swap_ = order != std::endian::native; }

  // The first bytes of the file, fewer when it is shorter, without moving on. Only at the begin of the file.
  std::string peek(std::size_t bytes);

  // All throw InputError when the file ends before, naming `what` was expected there.
  template <class T>
  T number(const char* what) {
    T value;
    read(&value, sizeof value, what);
    return swap_ ? byte_swapped(value) : value;
  }
  // Appends `count` numbers.
  template <class T>
  void numbers(std::uint64_t count, const char* what, std::vector<T>& out) {
    while (count > 0) {
      const std::size_t now = static_cast<std::size_t>(std::min<std::uint64_t>(count, chunk_bytes / sizeof(T)));
      const std::size_t begin = out.size();
      check_there(now * sizeof(T), what);
      out.resize(begin + now);
      read(out.data() + begin, now * sizeof(T), what);
      if (swap_) {
        for (std::size_t i = begin; i < out.size(); ++i) out[i] = byte_swapped(out[i]);
      }
      count -= now;
    }
  }
  void skip(std::uint64_t bytes, const char* what);

  bool at_end();
  std::uint64_t offset() const { return offset_; }
  // Of the decompressed file. Compressed ones are read through once to know it.
  std::uint64_t size();
  std::uint64_t remaining() { return size() - offset_; }
  void rewind();
  bool is_compressed() const { return compressed_; }

  const std::string& path() const { return path_; }
  // Throws InputError that names the present offset.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct Close {
    void operator()(gzFile_s* file) const;
  };
  static constexpr std::size_t chunk_bytes = std::size_t{1} << 22;

  void read(void* to, std::size_t bytes, const char* what);
  // Bytes that were there, at most `bytes`.
  std::size_t read_some(void* to, std::size_t bytes);
  void check_there(std::uint64_t bytes, const char* what);
  [[noreturn]] void fail_at_end(const char* what) const;

  std::string path_;
  std::unique_ptr<gzFile_s, Close> file_;
  std::string ahead_;  // read by peek() or at_end(), not yet by read()
  std::uint64_t offset_ = 0;
  std::optional<std::uint64_t> size_;
  bool compressed_ = false;
  bool swap_ = false;
};

}  // namespace replay
