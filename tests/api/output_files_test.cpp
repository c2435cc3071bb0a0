// Files that cannot be written: the status is io, the text names the file and the reason, and the simulation goes on.
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <algorithm>

#include "api_test_tools.h"

namespace insitu {
namespace {

using testing::Cloud;
using testing::fails;
using testing::Studio;
using testing::TemporaryFolder;
using testing::text_of;
using testing::works;

// A step that writes an image; the status of insitu_image_write, which insitu_step_end has to repeat.
insitu_status write_in_a_step(Studio& studio, const std::string& pattern, std::uint64_t step = 7,
                              const insitu_image* image = nullptr) {
  const Cloud cloud(20);
  const insitu_image target = image != nullptr ? *image : studio.image;
  insitu_step_begin(studio.context, step, 0.5 * static_cast<double>(step));
  insitu_particles_update(studio.context, studio.geometry, &cloud.desc);
  insitu_commit(studio.context);
  EXPECT_TRUE(works(studio.context, insitu_render(studio.context, studio.view, target)));
  const insitu_status status = insitu_image_write(studio.context, target, pattern.c_str());
  const std::string text = status == INSITU_OK ? "" : studio.context.error();
  EXPECT_EQ(insitu_step_end(studio.context), status);
  if (status != INSITU_OK) {
    EXPECT_EQ(studio.context.error(), text);
  }
  return status;
}

void expect_next_step_works(Studio& studio) {
  const TemporaryFolder folder;
  EXPECT_TRUE(works(studio.context, write_in_a_step(studio, folder.file("next.png"))));
  EXPECT_EQ(folder.names(), std::vector<std::string>{"next.png"});
}

TEST(OutputFiles, NamesWithStepAndTime) {
  Studio studio;
  const TemporaryFolder folder;
  for (const char* pattern : {"plain.png", "a{step}.png", "b{step:6}.exr", "c{{step}}.EXR", "d{time}.PNG"})
    EXPECT_TRUE(works(studio.context, write_in_a_step(studio, folder.file(pattern), 42)));
  std::vector<std::string> names = folder.names();
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"a42.png", "b000042.exr", "c{step}.EXR", "d21.PNG", "plain.png"}));
}

TEST(OutputFiles, NamesThatCannotBe) {
  Studio studio;
  const TemporaryFolder folder;
  for (const char* pattern : {"{stp}.png", "{step:0}.png", "{step:99}.png", "{step.png", "step}.png", "{}.png"}) {
    const insitu_status status = write_in_a_step(studio, folder.file(pattern));
    EXPECT_TRUE(fails(studio.context, status, INSITU_ERROR_INVALID_ARGUMENT, {pattern, "{step}"}));
  }
  for (const char* pattern : {"a.jpg", "a", "png", "a.png.gz"})
    EXPECT_TRUE(fails(studio.context, write_in_a_step(studio, folder.file(pattern)), INSITU_ERROR_UNSUPPORTED,
                      {pattern, ".png"}));
  EXPECT_TRUE(folder.names().empty());
  expect_next_step_works(studio);
}

TEST(OutputFiles, AFolderThatDoesNotExist) {
  Studio studio;
  const TemporaryFolder folder;
  for (const char* name : {"none/a.png", "none/a.exr"})
    EXPECT_TRUE(fails(studio.context, write_in_a_step(studio, folder.file(name)), INSITU_ERROR_IO,
                      {folder.file(name), "does not exist"}));
  EXPECT_TRUE(folder.names().empty());
  expect_next_step_works(studio);
}

TEST(OutputFiles, AFolderThatIsAFile) {
  Studio studio;
  const TemporaryFolder folder;
  EXPECT_TRUE(works(studio.context, write_in_a_step(studio, folder.file("a.png"))));
  const std::string before = text_of(folder.file("a.png"));
  EXPECT_TRUE(fails(studio.context, write_in_a_step(studio, folder.file("a.png/b.png")), INSITU_ERROR_IO,
                    {folder.file("a.png/b.png"), "not a folder"}));
  EXPECT_TRUE(text_of(folder.file("a.png")) == before);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.png"});
  expect_next_step_works(studio);
}

TEST(OutputFiles, AFileThatIsAFolder) {
  Studio studio;
  const TemporaryFolder folder;
  ASSERT_EQ(mkdir(folder.file("a.png").c_str(), 0700), 0);
  EXPECT_TRUE(fails(studio.context, write_in_a_step(studio, folder.file("a.png")), INSITU_ERROR_IO,
                    {folder.file("a.png"), "folder"}));
  expect_next_step_works(studio);
}

// A file system of 64 KiB that no other process sees, over the folder; false where that is not allowed.
bool mount_small_disk(const std::string& folder) {
  return geteuid() == 0 && unshare(CLONE_NEWNS) == 0 &&
         mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("insitu_test", folder.c_str(), "tmpfs", 0, "size=64k") == 0;
}

TEST(OutputFiles, AFullDisk) {
  const TemporaryFolder folder;
  if (!mount_small_disk(folder.path())) GTEST_SKIP() << "needs the right to mount a small tmpfs";
  Studio studio;
  const insitu_image large = testing::make_image(studio.context, 1000, 1000);
  for (const char* name : {"a.exr", "b.exr"}) {
    const std::string path = folder.file(name);
    EXPECT_TRUE(works(studio.context, write_in_a_step(studio, path)));
    const std::string before = text_of(path);
    ASSERT_FALSE(before.empty());
    EXPECT_TRUE(fails(studio.context, write_in_a_step(studio, path, 8, &large), INSITU_ERROR_IO,
                      {path, "No space left on device"}));
    EXPECT_TRUE(text_of(path) == before) << "the good file stays";
    EXPECT_TRUE(fails(studio.context, write_in_a_step(studio, folder.file("new.exr"), 8, &large), INSITU_ERROR_IO,
                      {"new.exr", "No space left on device"}));
    EXPECT_TRUE(works(studio.context, write_in_a_step(studio, path, 9)));
  }
  EXPECT_EQ(folder.names().size(), 2u) << "nothing half written is left";
  EXPECT_EQ(umount2(folder.path().c_str(), MNT_DETACH), 0);
  expect_next_step_works(studio);
}

std::size_t line_count(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(OutputFiles, AReportThatCannotBeWritten) {
  Studio studio;
  const Cloud cloud(20);
  const TemporaryFolder folder;
  const std::string path = folder.file("none/report.jsonl");
  EXPECT_TRUE(works(studio.context, insitu_context_set_report(studio.context, path.c_str())))
      << "the file is opened per step";
  EXPECT_TRUE(fails(studio.context, studio.step(cloud.desc), INSITU_ERROR_IO, {path, "does not exist"}));
  // An error of the step itself comes first.
  insitu_step_begin(studio.context, 1, 0.0);
  EXPECT_NE(insitu_render(studio.context, studio.view, studio.image), INSITU_OK);
  EXPECT_TRUE(fails(studio.context, insitu_step_end(studio.context), INSITU_ERROR_WRONG_STATE, {"insitu_commit"}));

  ASSERT_EQ(mkdir(folder.file("none").c_str(), 0700), 0);
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
  EXPECT_EQ(line_count(text_of(path)), 1u);
  EXPECT_TRUE(works(studio.context, insitu_context_set_report(studio.context, nullptr)));
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
  EXPECT_EQ(line_count(text_of(path)), 1u);
}

TEST(OutputFiles, AReportOnAFullDisk) {
  const TemporaryFolder folder;
  if (!mount_small_disk(folder.path())) GTEST_SKIP() << "needs the right to mount a small tmpfs";
  Studio studio;
  const Cloud cloud(20);
  const std::string path = folder.file("report.jsonl");
  insitu_context_set_report(studio.context, path.c_str());
  std::size_t steps = 0;
  insitu_status status = INSITU_OK;
  while (status == INSITU_OK && steps < 2000) status = studio.step(cloud.desc, steps++);
  EXPECT_TRUE(fails(studio.context, status, INSITU_ERROR_IO, {path, "No space left on device"}));
  const std::string full = text_of(path);
  EXPECT_GT(steps, 50u);
  EXPECT_EQ(line_count(full), steps - 1);
  EXPECT_EQ(full.back(), '\n') << "no half line";
  EXPECT_GT(studio.picture().hits(), 0u) << "the step itself was fine";
  EXPECT_TRUE(fails(studio.context, studio.step(cloud.desc), INSITU_ERROR_IO, {path}));
  EXPECT_TRUE(text_of(path) == full);
  EXPECT_EQ(truncate(path.c_str(), 0), 0);
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));
  EXPECT_EQ(line_count(text_of(path)), 1u);
  EXPECT_EQ(umount2(folder.path().c_str(), MNT_DETACH), 0);
}

}  // namespace
}  // namespace insitu
