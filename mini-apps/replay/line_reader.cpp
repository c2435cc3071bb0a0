#include "line_reader.h"

#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "input_error.h"
#include "input_file.h"
#include "numbers.h"

namespace replay {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 17;
// No format here has lines of that length: a binary file without line ends must not fill the memory.
constexpr std::size_t longest_line = std::size_t{1} << 20;
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

}  // namespace

void LineReader::Close::operator()(gzFile_s* file) const { gzclose_r(file); }

LineReader::LineReader(std::string path) : path_(std::move(path)) {
  if (const std::string reason = reason_not_to_open(path_); !reason.empty()) throw InputError(path_, 0, reason);
  file_.reset(gzopen(path_.c_str(), "rb"));
  if (!file_) throw InputError(path_, 0, "cannot be opened: " + std::string(std::strerror(errno)));
  gzbuffer(file_.get(), static_cast<unsigned>(buffer_bytes));
  buffer_.resize(buffer_bytes);
}

bool LineReader::fill_buffer() {
  const int got = gzread(file_.get(), buffer_.data(), static_cast<unsigned>(buffer_.size()));
  buffer_at_ = 0;
  buffer_end_ = got > 0 ? static_cast<std::size_t>(got) : 0;
  if (got < static_cast<int>(buffer_.size())) {
    int code = Z_OK;
    const char* const text = gzerror(file_.get(), &code);
    // What was decompressed before the damage is still read; the error then comes at its end.
    if (code == Z_BUF_ERROR && buffer_end_ == 0) fail_at_end("the rest of the compressed data: it is cut off");
    if (code != Z_OK && code != Z_BUF_ERROR && code != Z_STREAM_END) {
      throw InputError(path_, line_number_ + 1, "the compressed data are damaged (" + std::string(text) + ")");
    }
  }
  return buffer_end_ > 0;
}

bool LineReader::read_line() {
  text_.clear();
  bool found = false;
  while (buffer_at_ < buffer_end_ || fill_buffer()) {
    found = true;
    const char* const begin = buffer_.data() + buffer_at_;
    const std::size_t rest = buffer_end_ - buffer_at_;
    const void* const line_end = std::memchr(begin, '\n', rest);
    const std::size_t length =
        line_end == nullptr ? rest : static_cast<std::size_t>(static_cast<const char*>(line_end) - begin);
    text_.append(begin, length);
    buffer_at_ += length + (line_end == nullptr ? 0 : 1);
    if (text_.size() > longest_line) {
      throw InputError(path_, line_number_ + 1, "the line has more than a million characters, expected a text file");
    }
    if (line_end != nullptr) break;
  }
  return found;
}

bool LineReader::next() {
  if (std::exchange(unread_, false)) return true;
  if (!read_line()) {
    if (line_number_ == 0) throw InputError(path_, 0, "is empty");
    return false;
  }
  ++line_number_;
  line_ = text_;
  if (line_number_ == 1 && line_.substr(0, byte_order_mark.size()) == byte_order_mark) {
    line_.remove_prefix(byte_order_mark.size());
  }
  if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
  if (line_.find('\0') != std::string_view::npos) fail("the line holds binary data, expected a text file");
  split_words(line_, words_);
  return true;
}

bool LineReader::next_filled() {
  while (next()) {
    if (!words_.empty()) return true;
  }
  return false;
}

void LineReader::fail(const std::string& what) const { throw InputError(path_, line_number_, what); }

void LineReader::fail_at_end(const std::string& expected) const {
  std::string what = "the file ends here, expected ";
  what += expected;
  throw InputError(path_, line_number_, what);
}

}  // namespace replay
