// Files for the tests of the readers, and what the readers make of them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "frame.h"
#include "reader.h"

namespace replay::test {

// A folder of its own for each test, removed with its content at the end.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path(std::string_view name) const { return (path_ / name).string(); }
  std::string write(std::string_view name, std::string_view text) const;
  std::string write_gz(std::string_view name, std::string_view text) const;

 private:
  std::filesystem::path path_;
};

std::vector<Frame> read_all(const std::string& path, const ReadOptions& options = {});
// The message with which reading fails, without the folder; empty when it does not fail.
std::string error_of(const std::string& path, const ReadOptions& options = {});

// Values of an attribute; fails the test when there is none.
std::vector<double> values(const Frame& frame, std::string_view name);

}  // namespace replay::test
