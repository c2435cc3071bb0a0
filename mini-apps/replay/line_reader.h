// Reads a text file, compressed by gzip or not, line by line, and knows where it is for error messages.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "numbers.h"

struct gzFile_s;

namespace replay {

class LineReader {
 public:
  // Throws InputError when the file cannot be opened, is a folder or is empty.
  explicit LineReader(std::string path);

  // Goes to the next line; false at the end of the file. Throws InputError when the bytes are no text, or when the
  // compressed stream is damaged or cut off.
  bool next();
  // The next call of next() gives the present line once more.
  void unread() { unread_ = true; }
  // As next(), but passes over blank lines.
  bool next_filled();

  // Both live until the next call of next(). Line ends, also those of Windows, are cut off.
  std::string_view line() const { return line_; }
  const Words& words() const { return words_; }

  const std::string& path() const { return path_; }
  std::size_t line_number() const { return line_number_; }
  // Throws InputError for the present line.
  [[noreturn]] void fail(const std::string& what) const;
  // Throws InputError for the end of the file, which came too early.
  [[noreturn]] void fail_at_end(const std::string& expected) const;

 private:
  struct Close {
    void operator()(gzFile_s* file) const;
  };
  bool fill_buffer();
  bool read_line();

  std::string path_;
  std::unique_ptr<gzFile_s, Close> file_;
  std::vector<char> buffer_;
  std::size_t buffer_at_ = 0;
  std::size_t buffer_end_ = 0;
  std::string text_;
  std::string_view line_;
  Words words_;
  std::size_t line_number_ = 0;
  bool unread_ = false;
};

}  // namespace replay
