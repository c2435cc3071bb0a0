// The part of HDF5 that snapshots use: groups, attributes of numbers, and arrays of numbers. The only place that knows
// the library.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scalars.h"

namespace replay {

class Hdf5File {
 public:
  struct Array {
    std::vector<std::uint64_t> extent;  // rows, columns, ...; empty for a single number
    bool numbers = false;               // of a type that Scalars has or can hold
  };

  // Compressed files are unpacked into memory. All functions throw InputError.
  explicit Hdf5File(std::string path);
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  // Whether there is something of that name, and, when it is a link, behind it.
  bool has(const std::string& name) const;
  // What a group holds, in the order of the names; arrays only.
  std::vector<std::string> arrays_in(const std::string& group) const;
  std::vector<std::string> groups_in(const std::string& group) const;
  Array describe(const std::string& array) const;
  // All values, row by row, once the file has been found large enough to hold them.
  Scalars read(const std::string& array) const;
  // The numbers of an attribute; none when there is no such object or attribute, or when it holds no numbers.
  std::vector<double> attribute(const std::string& object, const std::string& name) const;

  const std::string& path() const { return path_; }
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::vector<std::string> members(const std::string& group, bool groups) const;
  [[noreturn]] void fail_with_reason(const std::string& what) const;

  std::string path_;
  std::vector<char> unpacked_;  // of a compressed file
  std::int64_t file_ = -1;
  std::uint64_t bytes_ = 0;
};

// Whether the bytes are the signature at the beginning of a file.
bool is_hdf5(std::string_view first_bytes);

}  // namespace replay
