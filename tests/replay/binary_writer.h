// Writes small binary files for the tests, in either byte order, with the records of Fortran around what it is told.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace replay::test {

class BinaryWriter {
 public:
  explicit BinaryWriter(std::endian order = std::endian::little) : order_(order) {}

  template <class T>
  BinaryWriter& put(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (order_ != std::endian::native) std::reverse(bytes, bytes + sizeof(T));
    text_.append(bytes, sizeof(T));
    return *this;
  }
  template <class T>
  BinaryWriter& put_all(const std::vector<T>& values) {
    for (const T value : values) put(value);
    return *this;
  }
  BinaryWriter& put_text(std::string_view text) {
    text_ += text;
    return *this;
  }
  BinaryWriter& fill(std::size_t bytes) {
    text_.append(bytes, '\0');
    return *this;
  }
  // The size, what the other writer has, and the size again.
  template <class Marker = std::uint32_t>
  BinaryWriter& record(const BinaryWriter& content) {
    const auto size = static_cast<Marker>(content.text_.size());
    return put(size).put_text(content.text_).put(size);
  }

  BinaryWriter like() const { return BinaryWriter(order_); }
  const std::string& text() const { return text_; }
  std::size_t size() const { return text_.size(); }

 private:
  std::endian order_;
  std::string text_;
};

}  // namespace replay::test
