// The file of a report: lines are added whole, and the reason is told when they cannot be.
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "report/report.h"
#include "temporary_folder.h"

namespace insitu {
namespace {

class AppendLine : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_.file(name); }

  static std::string content(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

  static void expect_failure(const AppendResult& result, const std::string& path, const std::string& reason) {
    EXPECT_EQ(result.status, INSITU_ERROR_IO);
    EXPECT_EQ(result.message, "cannot append to \"" + path + "\": " + reason);
  }

  testing::TemporaryFolder folder_;
};

TEST_F(AppendLine, MakesTheFileAndAdds) {
  EXPECT_EQ(append_line(file("r.jsonl"), "{\"a\":1}").status, INSITU_OK);
  EXPECT_EQ(content(file("r.jsonl")), "{\"a\":1}\n");
  const AppendResult result = append_line(file("r.jsonl"), "");
  EXPECT_EQ(result.status, INSITU_OK);
  EXPECT_EQ(result.message, "");
  EXPECT_EQ(append_line(file("r.jsonl"), "b").status, INSITU_OK);
  EXPECT_EQ(content(file("r.jsonl")), "{\"a\":1}\n\nb\n");
}

TEST_F(AppendLine, LeavesNoFileOpen) {
  const auto open_files = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), std::filesystem::directory_iterator());
  };
  const auto before = open_files();
  for (int i = 0; i < 20; ++i) append_line(file(i % 2 ? "r.jsonl" : "none/r.jsonl"), "a");
  EXPECT_EQ(open_files(), before);
}

TEST_F(AppendLine, PlacesThatDoNotExist) {
  expect_failure(append_line(file("none/r.jsonl"), "a"), file("none/r.jsonl"), "its folder does not exist");
  expect_failure(append_line(file("."), "a"), file("."), "Is a directory");
  expect_failure(append_line("", "a"), "", "its folder does not exist");
  ASSERT_EQ(append_line(file("r.jsonl"), "a").status, INSITU_OK);
  expect_failure(append_line(file("r.jsonl/b"), "a"), file("r.jsonl/b"), "Not a directory");
}

TEST_F(AppendLine, DeviceThatIsAlwaysFull) {
  expect_failure(append_line("/dev/full", "a"), "/dev/full", "No space left on device");
}

TEST_F(AppendLine, HalfALineIsCutOffWhenTheDiskIsFull) {
  const bool mounted = geteuid() == 0 && unshare(CLONE_NEWNS) == 0 &&
                       mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                       mount("insitu_test", folder_.path().c_str(), "tmpfs", 0, "size=16k") == 0;
  if (!mounted) GTEST_SKIP() << "needs the right to mount a small tmpfs";
  const std::string path = file("r.jsonl");
  ASSERT_EQ(append_line(path, "first").status, INSITU_OK);
  expect_failure(append_line(path, std::string(50000, 'x')), path, "No space left on device");
  EXPECT_EQ(content(path), "first\n");
  EXPECT_EQ(append_line(path, "second").status, INSITU_OK) << "the next one works";
  EXPECT_EQ(content(path), "first\nsecond\n");
  EXPECT_EQ(umount2(folder_.path().c_str(), MNT_DETACH), 0);
}

TEST_F(AppendLine, LimitOnFileSizeDoesNotKill) {
  const std::string path = file("r.jsonl");
  ASSERT_EQ(append_line(path, "first").status, INSITU_OK);
  rlimit old_limit;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  const rlimit small{1000, old_limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const AppendResult result = append_line(path, std::string(995, 'x'));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old_limit), 0);
  expect_failure(result, path, "File too large");
  EXPECT_EQ(content(path), "first\n");
}

TEST_F(AppendLine, LinesOfSeveralWritersDoNotMix) {
  const std::string path = file("r.jsonl");
  constexpr int writer_count = 4;
  constexpr int line_count = 50;
  {
    std::vector<std::jthread> writers;
    for (int writer = 0; writer < writer_count; ++writer) {
      writers.emplace_back([&path, writer] {
        const std::string line(2000, static_cast<char>('a' + writer));
        for (int i = 0; i < line_count; ++i) append_line(path, line);
      });
    }
  }
  std::ifstream stream(path);
  int lines = 0;
  for (std::string line; std::getline(stream, line); ++lines) ASSERT_EQ(line, std::string(2000, line.at(0)));
  EXPECT_EQ(lines, writer_count * line_count);
}

}  // namespace
}  // namespace insitu
