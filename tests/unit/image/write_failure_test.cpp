// A file is written whole or not at all, and the reason is told.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <vector>

#include "image/image_writer.h"
#include "image_test_tools.h"

namespace insitu {
namespace {

using testing::all_channels;
using testing::bytes_of;
using testing::noisy_frame;
using testing::some_metadata;
using testing::TemporaryFolder;

using Names = std::vector<std::string>;

WriteResult write_to(const std::string& path, uint32_t side = 8) {
  return write_image(noisy_frame(side, side, all_channels), some_metadata(), path);
}

// The status, and a message that names the file and says `reason`.
void expect_failure(const WriteResult& result, insitu_status status, const std::string& path,
                    const std::string& reason) {
  EXPECT_EQ(result.status, status);
  EXPECT_EQ(result.file_bytes, 0u);
  EXPECT_NE(result.message.find('"' + path + '"'), std::string::npos) << result.message;
  EXPECT_NE(result.message.find(reason), std::string::npos) << result.message;
}

Names sorted_names(const TemporaryFolder& folder) {
  Names names = folder.names();
  std::sort(names.begin(), names.end());
  return names;
}

TEST(WriteFailure, FolderIsMissing) {
  const TemporaryFolder folder;
  const std::string path = folder.file("none/a.png");
  expect_failure(write_to(path), INSITU_ERROR_IO, path, "the folder \"" + folder.file("none") + "\" does not exist");
  EXPECT_EQ(folder.names(), Names{});
}

TEST(WriteFailure, FolderIsAFile) {
  const TemporaryFolder folder;
  ASSERT_EQ(write_to(folder.file("a.png")).status, INSITU_OK);
  const std::string path = folder.file("a.png/b.exr");
  expect_failure(write_to(path), INSITU_ERROR_IO, path, "is not a folder");
  EXPECT_EQ(folder.names(), Names{"a.png"});
}

TEST(WriteFailure, TargetIsAFolderOrADevice) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.exr"}) {
    std::filesystem::create_directory(folder.file(name));
    expect_failure(write_to(folder.file(name)), INSITU_ERROR_IO, folder.file(name), "it is a folder");
    std::filesystem::remove(folder.file(name));
  }
  ASSERT_EQ(mkfifo(folder.file("pipe.png").c_str(), 0600), 0);
  expect_failure(write_to(folder.file("pipe.png")), INSITU_ERROR_IO, folder.file("pipe.png"), "not a regular file");
  EXPECT_EQ(folder.names(), Names{"pipe.png"});
}

TEST(WriteFailure, OtherEndings) {
  const TemporaryFolder folder;
  for (const char* name : {"a.jpg", "a", "a.png.gz", "a.", ".png", ".exr", "png", "a.pn", "a.exr "}) {
    const WriteResult result = write_to(name[0] == '.' ? name : folder.file(name));
    EXPECT_EQ(result.status, INSITU_ERROR_UNSUPPORTED) << name;
    EXPECT_NE(result.message.find(".png or .exr"), std::string::npos) << result.message;
  }
  EXPECT_EQ(write_to("").status, INSITU_ERROR_UNSUPPORTED);
  EXPECT_EQ(folder.names(), Names{});
}

TEST(WriteFailure, FramesWithoutPixels) {
  const TemporaryFolder folder;
  FrameBuffer frame;
  EXPECT_EQ(write_image(frame, {}, folder.file("a.png")).status, INSITU_ERROR_INVALID_ARGUMENT);
  frame = noisy_frame(4, 4, all_channels);
  frame.normal.pop_back();
  EXPECT_EQ(write_image(frame, {}, folder.file("a.exr")).status, INSITU_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(folder.names(), Names{});
}

TEST(WriteFailure, SidesPastTheFormat) {
  const TemporaryFolder folder;
  const WriteResult result = write_image(noisy_frame(1000001, 1, 0), {}, folder.file("a.png"));
  expect_failure(result, INSITU_ERROR_UNSUPPORTED, folder.file("a.png"), "1000000 pixels per side");
  EXPECT_EQ(write_image(noisy_frame(1000000, 1, 0), {}, folder.file("a.png")).status, INSITU_OK);
}

TEST(WriteFailure, NoPermission) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, who can act as another user";
  const TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
  const std::string path = folder.file("a.png");
  ASSERT_EQ(write_to(path).status, INSITU_OK);
  const std::vector<char> before = bytes_of(path);

  ASSERT_EQ(seteuid(65534), 0);
  const WriteResult new_file = write_to(folder.file("b.exr"));
  const WriteResult old_file = write_to(path, 9);
  ASSERT_EQ(seteuid(0), 0);
  expect_failure(new_file, INSITU_ERROR_IO, folder.file("b.exr"), "Permission denied");
  expect_failure(old_file, INSITU_ERROR_IO, path, "Permission denied");

  // Others may write into the folder, but not into the file: it is not replaced behind the owner's back.
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0777));
  std::filesystem::permissions(path, std::filesystem::perms(0444));
  ASSERT_EQ(seteuid(65534), 0);
  const WriteResult read_only = write_to(path, 9);
  ASSERT_EQ(seteuid(0), 0);
  expect_failure(read_only, INSITU_ERROR_IO, path, "Permission denied");

  EXPECT_EQ(bytes_of(path), before);
  EXPECT_EQ(folder.names(), Names{"a.png"});
}

// Makes the folder a file system of 64 kB that no other process sees; false when the system does not allow it.
bool mount_small_disk(const std::string& folder) {
  return geteuid() == 0 && unshare(CLONE_NEWNS) == 0 &&
         mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("insitu_test", folder.c_str(), "tmpfs", 0, "size=64k") == 0;
}

TEST(WriteFailure, DiskIsFull) {
  const TemporaryFolder folder;
  if (!mount_small_disk(folder.path().string())) GTEST_SKIP() << "needs the right to mount a small tmpfs";
  for (const char* name : {"a.png", "b.exr"}) {
    const std::string path = folder.file(name);
    const WriteResult first = write_to(path);
    EXPECT_EQ(first.status, INSITU_OK) << first.message;
    const std::vector<char> before = bytes_of(path);
    expect_failure(write_to(path, 256), INSITU_ERROR_IO, path, "No space left on device");
    EXPECT_EQ(bytes_of(path), before);
    expect_failure(write_to(folder.file("new.exr"), 256), INSITU_ERROR_IO, folder.file("new.exr"),
                   "No space left on device");
    EXPECT_EQ(write_to(path, 9).status, INSITU_OK) << "the next one works";
  }
  EXPECT_EQ(sorted_names(folder), (Names{"a.png", "b.exr"}));
  EXPECT_EQ(umount2(folder.path().c_str(), MNT_DETACH), 0);
}

TEST(WriteFailure, LimitOnFileSizeDoesNotKill) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  ASSERT_EQ(write_to(path).status, INSITU_OK);
  const std::vector<char> before = bytes_of(path);
  rlimit old_limit;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  const rlimit small{10000, old_limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const WriteResult result = write_to(path, 256);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old_limit), 0);
  expect_failure(result, INSITU_ERROR_IO, path, "File too large");
  EXPECT_EQ(bytes_of(path), before);
  EXPECT_EQ(folder.names(), Names{"a.png"});
}

TEST(WriteFailure, LongNamesLeaveRoomForTheTemporaryOne) {
  const TemporaryFolder folder;
  const std::string longest(251, 'a');
  EXPECT_EQ(write_to(folder.file(longest + ".png")).status, INSITU_OK);
  expect_failure(write_to(folder.file(longest + "a.png")), INSITU_ERROR_IO, folder.file(longest + "a.png"),
                 "File name too long");
  EXPECT_EQ(folder.names(), Names{longest + ".png"});
}

TEST(WriteFailure, ExistingFilesAndLinksAreReplaced) {
  const TemporaryFolder folder;
  ASSERT_EQ(write_to(folder.file("a.png"), 8).status, INSITU_OK);
  const std::vector<char> first = bytes_of(folder.file("a.png"));
  std::filesystem::create_symlink("a.png", folder.file("link.png"));
  ASSERT_EQ(write_to(folder.file("link.png"), 9).status, INSITU_OK);
  EXPECT_FALSE(std::filesystem::is_symlink(folder.file("link.png")));
  EXPECT_EQ(bytes_of(folder.file("a.png")), first);
  ASSERT_EQ(write_to(folder.file("a.png"), 9).status, INSITU_OK);
  EXPECT_EQ(bytes_of(folder.file("a.png")), bytes_of(folder.file("link.png")));
  EXPECT_EQ(sorted_names(folder), (Names{"a.png", "link.png"}));
}

TEST(WriteFailure, FilesGetTheUsualPermissions) {
  const TemporaryFolder folder;
  const mode_t old_mask = umask(0027);
  const insitu_status status = write_to(folder.file("a.png")).status;
  umask(old_mask);
  ASSERT_EQ(status, INSITU_OK);
  EXPECT_EQ(std::filesystem::status(folder.file("a.png")).permissions(), std::filesystem::perms(0640));
}

}  // namespace
}  // namespace insitu
