// Writing an image leaves no trace in the process that hosts the library.
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/ustring.h>
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <clocale>
#include <filesystem>
#include <iterator>
#include <locale>
#include <string>
#include <thread>

#include "image/image_writer.h"
#include "image_test_tools.h"

// Every thread of this process is started through here, also those of shared libraries. Sanitizers have their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool counts_threads = false;
static std::atomic<int> threads_started{0};
#else
constexpr bool counts_threads = true;
static std::atomic<int> threads_started{0};
extern "C" __attribute__((visibility("default"))) int pthread_create(pthread_t* thread,
                                                                     const pthread_attr_t* attributes,
                                                                     void* (*start)(void*), void* argument) noexcept {
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  ++threads_started;
  return create(thread, attributes, start, argument);
}
#endif

namespace insitu {
namespace {

using testing::all_channels;
using testing::noisy_frame;
using testing::some_metadata;
using testing::TemporaryFolder;

long thread_count() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/task"), std::filesystem::directory_iterator());
}

int oiio_attribute(const char* name) {
  int value = -12345;
  EXPECT_TRUE(OIIO::getattribute(name, value)) << name;
  return value;
}

TEST(HostState, NoThreadIsStarted) {
  if (counts_threads) {
    const int before = threads_started;
    std::thread([] {}).join();
    ASSERT_EQ(threads_started, before + 1) << "the counter does not count";
  }
  const TemporaryFolder folder;
  const FrameBuffer frame = noisy_frame(256, 256, all_channels);
  const int started = threads_started;
  const long running = thread_count();
  for (const char* name : {"a.png", "a.exr", "b.exr", "b.png"}) {
    ASSERT_EQ(write_image(frame, some_metadata(), folder.file(name)).status, INSITU_OK);
    EXPECT_EQ(thread_count(), running) << name;
  }
  EXPECT_EQ(threads_started, started);
}

TEST(HostState, OpenImageIoIsSetUpAsBefore) {
  const TemporaryFolder folder;
  const FrameBuffer frame = noisy_frame(16, 16, all_channels);
  const int exr_threads = oiio_attribute("exr_threads");
  const int threads = oiio_attribute("threads");
  for (const int wanted : {exr_threads, 0, 3, -1}) {
    ASSERT_TRUE(OIIO::attribute("exr_threads", wanted));
    const int set = oiio_attribute("exr_threads");
    for (const char* name : {"a.png", "a.exr", "none/a.exr"}) write_image(frame, some_metadata(), folder.file(name));
    EXPECT_EQ(oiio_attribute("exr_threads"), set);
    EXPECT_EQ(oiio_attribute("threads"), threads);
  }
  OIIO::attribute("exr_threads", exr_threads);
}

TEST(HostState, NothingIsPrinted) {
  const TemporaryFolder folder;
  const FrameBuffer frame = noisy_frame(16, 16, all_channels, 0.5f);
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  for (const char* name : {"a.png", "a.exr", "none/a.png", "none/a.exr", "a.tif", "a"}) {
    write_image(frame, some_metadata(), folder.file(name));
  }
  write_image(noisy_frame(1000001, 1, 0), some_metadata(), folder.file("wide.png"));
  write_image(FrameBuffer(), some_metadata(), folder.file("empty.png"));
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

// Texts given to OpenImageIO stay in its table for ever: a run of many steps must not fill it.
TEST(HostState, OpenImageIoCollectsNoTexts) {
  const TemporaryFolder folder;
  const FrameBuffer frame = noisy_frame(8, 8, all_channels);
  const auto write_step = [&](uint64_t step) {
    ImageMetadata metadata = some_metadata();
    metadata.step = step;
    metadata.time = 0.001 * static_cast<double>(step);
    metadata.seconds_render = 0.1 + 1e-7 * static_cast<double>(step);
    metadata.camera.eye[0] = static_cast<double>(step) / 3.0;
    const std::string name = "frame_" + std::to_string(step);
    ASSERT_EQ(write_image(frame, metadata, folder.file(name + ".png")).status, INSITU_OK);
    ASSERT_EQ(write_image(frame, metadata, folder.file(name + ".exr")).status, INSITU_OK);
  };
  write_step(0);
  const size_t texts = OIIO::ustring::total_ustrings();
  for (uint64_t step = 1; step <= 50; ++step) write_step(step);
  EXPECT_EQ(OIIO::ustring::total_ustrings(), texts);
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(HostState, NumbersHaveAPointInEveryLocale) {
  const TemporaryFolder folder;
  const FrameBuffer frame = noisy_frame(8, 8, all_channels);
  ASSERT_EQ(write_image(frame, some_metadata(), folder.file("plain.png")).status, INSITU_OK);
  ASSERT_EQ(write_image(frame, some_metadata(), folder.file("plain.exr")).status, INSITU_OK);

  // C++ streams by a locale of our own; C functions by one of the system, where there is one.
  const std::locale old_locale = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  const std::string old_name = std::setlocale(LC_ALL, nullptr);
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8", "it_IT.UTF-8", "es_ES.UTF-8"}) {
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  }
  const std::string name_before = std::setlocale(LC_ALL, nullptr);
  const WriteResult png = write_image(frame, some_metadata(), folder.file("comma.png"));
  const WriteResult exr = write_image(frame, some_metadata(), folder.file("comma.exr"));
  const std::string name_after = std::setlocale(LC_ALL, nullptr);
  std::setlocale(LC_ALL, old_name.c_str());
  std::locale::global(old_locale);

  EXPECT_EQ(name_after, name_before);
  ASSERT_EQ(png.status, INSITU_OK) << png.message;
  ASSERT_EQ(exr.status, INSITU_OK) << exr.message;
  EXPECT_EQ(testing::bytes_of(folder.file("comma.png")), testing::bytes_of(folder.file("plain.png")));
  EXPECT_EQ(testing::bytes_of(folder.file("comma.exr")), testing::bytes_of(folder.file("plain.exr")));
}

}  // namespace
}  // namespace insitu
