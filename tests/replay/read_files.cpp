#include "read_files.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <fstream>

#include "input_error.h"

namespace replay::test {

Folder::Folder() {
  const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
  path_ = std::filesystem::temp_directory_path() / ("insitu-replay-test-" + std::to_string(getpid())) /
          (std::string(test->test_suite_name()) + "." + test->name());
  std::filesystem::remove_all(path_);
  std::filesystem::create_directories(path_);
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  std::filesystem::remove(path_.parent_path(), ignored);
}

std::string Folder::write(std::string_view name, std::string_view text) const {
  // Some file systems put a file that is written anew on the disk at once, but not one that was not there before.
  std::filesystem::remove(path(name));
  std::ofstream(path(name), std::ios::binary) << text;
  return path(name);
}

std::string Folder::write_gz(std::string_view name, std::string_view text) const {
  const gzFile file = gzopen(path(name).c_str(), "wb");
  gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
  gzclose(file);
  return path(name);
}

std::vector<Frame> read_all(const std::string& path, const ReadOptions& options) {
  std::vector<Frame> frames;
  const auto reader = open_reader(path, options);
  Frame frame;
  while (reader->next(frame)) {
    for (const Attribute& attribute : frame.attributes) {
      EXPECT_EQ(attribute.size(), attribute.components * frame.count()) << attribute.name;
    }
    frames.push_back(frame);
  }
  return frames;
}

std::string error_of(const std::string& path, const ReadOptions& options) {
  try {
    read_all(path, options);
  } catch (const InputError& error) {
    const std::string folder = std::filesystem::path(path).parent_path().string() + "/";
    std::string what = error.what();
    if (what.compare(0, folder.size(), folder) == 0) what.erase(0, folder.size());
    return what;
  }
  return {};
}

std::vector<double> values(const Frame& frame, std::string_view name) {
  const Attribute* const attribute = frame.find(name);
  if (!attribute) {
    ADD_FAILURE() << "no attribute " << name << ", but " << frame.attribute_names();
    return {};
  }
  std::vector<double> all(attribute->size());
  for_each_value(attribute->scalars, [&all](std::size_t i, double value) { all[i] = value; });
  return all;
}

}  // namespace replay::test
