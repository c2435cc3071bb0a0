// How many threads the library has: never more than it was granted, the caller's own included.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "api_test_tools.h"

// Every thread of this process is started through here, also those of shared libraries.
static std::atomic<int> threads_started{0};
extern "C" __attribute__((visibility("default"))) int pthread_create(pthread_t* thread,
                                                                     const pthread_attr_t* attributes,
                                                                     void* (*start)(void*), void* argument) noexcept {
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  ++threads_started;
  return create(thread, attributes, start, argument);
}

namespace insitu {
namespace {

using testing::Cloud;
using testing::Context;
using testing::works;

int thread_count() {
  return static_cast<int>(
      std::distance(std::filesystem::directory_iterator("/proc/self/task"), std::filesystem::directory_iterator()));
}

// Counts the threads of the process all the time.
class Sampler {
 public:
  Sampler() : thread_([this] { run(); }) {
    while (samples_ == 0) std::this_thread::yield();
  }
  ~Sampler() { stop(); }
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;
  int most() {
    stop();
    return most_;
  }

 private:
  void run() {
    while (!done_) {
      most_ = std::max(most_, thread_count());
      ++samples_;
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }
  void stop() {
    done_ = true;
    if (thread_.joinable()) thread_.join();
  }

  int most_ = 0;
  std::atomic<int> samples_{0};
  std::atomic<bool> done_{false};
  std::thread thread_;
};

// A step with work for many threads: two sets, so that Embree has a scene to build, and files of both kinds.
void work(std::uint32_t max_threads, std::uint32_t order) {
  const testing::TemporaryFolder folder;
  const Context context(max_threads);
  const insitu_geometry geometries[2] = {testing::make_particles(context, order),
                                         testing::make_particles(context, order)};
  const insitu_view view = testing::make_view(context);
  const insitu_image image = testing::make_image(context, 128, 128, 2);
  Cloud one(100000, 1);
  Cloud two(100000, 2);
  one.position.flags = two.position.flags = INSITU_ARRAY_PERMUTABLE;
  insitu_step_begin(context, 0, 0.0);
  insitu_particles_update(context, geometries[0], &one.desc);
  insitu_particles_update(context, geometries[1], &two.desc);
  insitu_commit(context);
  insitu_render(context, view, image);
  insitu_image_write(context, image, folder.file("a.png").c_str());
  insitu_image_write(context, image, folder.file("a.exr").c_str());
  EXPECT_TRUE(works(context, insitu_step_end(context)));
}

// The first file loads the encoder, which is OpenImageIO and all that Debian links to it: log4cplus among it starts
// four threads, which sleep.
constexpr int threads_of_encoder = 4;
void write_first_file() {
  const testing::TemporaryFolder folder;
  const Context context(1);
  const insitu_view view = testing::make_view(context);
  const insitu_image image = testing::make_image(context, 4, 4);
  insitu_step_begin(context, 0, 0.0);
  insitu_commit(context);
  insitu_render(context, view, image);
  insitu_image_write(context, image, folder.file("a.png").c_str());
  EXPECT_TRUE(works(context, insitu_step_end(context)));
}

bool is_loaded(const std::string& library) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    if (line.find(library) != std::string::npos) return true;
  return false;
}

const bool encoder_loaded_at_start = is_loaded("libOpenImageIO");

// `extra` threads besides the caller's, and no more, whatever is done.
void expect_at_most(int extra, std::uint32_t max_threads) {
  write_first_file();
  Sampler sampler;
  const int before = thread_count();
  const int started = threads_started;
  for (const std::uint32_t order : {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY})
    work(max_threads, order);
  EXPECT_LE(sampler.most(), before + extra);
  EXPECT_LE(threads_started - started, extra) << "workers are kept, not started anew";
}

TEST(Threads, TheCounterCounts) {
  const int started = threads_started;
  std::thread([] {}).join();
  EXPECT_EQ(threads_started, started + 1);
}

// What writes no image is spared the encoder with all its libraries.
TEST(Threads, TheEncoderComesWithTheFirstFile) {
  EXPECT_FALSE(encoder_loaded_at_start);
  if (!is_loaded("libOpenImageIO")) {  // no other test has written one
    const int started = threads_started;
    const Context context(1);
    const insitu_geometry geometry = testing::make_particles(context);
    const insitu_view view = testing::make_view(context);
    const insitu_image image = testing::make_image(context, 16, 16);
    Cloud cloud(1000, 1);
    insitu_step_begin(context, 0, 0.0);
    insitu_particles_update(context, geometry, &cloud.desc);
    insitu_commit(context);
    insitu_render(context, view, image);
    EXPECT_TRUE(works(context, insitu_step_end(context)));
    EXPECT_FALSE(is_loaded("libOpenImageIO"));
    EXPECT_EQ(threads_started, started);
    write_first_file();
    EXPECT_LE(threads_started - started, threads_of_encoder);
  }
  EXPECT_TRUE(is_loaded("libOpenImageIO"));
  const int started = threads_started;
  write_first_file();
  EXPECT_EQ(threads_started, started);
}

TEST(Threads, OneIsTheCallersOwn) { expect_at_most(0, 1); }
TEST(Threads, TwoAreOneMore) { expect_at_most(1, 2); }
TEST(Threads, NoLimitIsThatOfTheMachine) {
  expect_at_most(std::max(1, static_cast<int>(std::thread::hardware_concurrency()) - 1), 0);
}

TEST(Threads, TheHostsOwnLimitHolds) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  expect_at_most(0, 8);
}

// Several contexts, one after another and at once, share what there is.
TEST(Threads, ManyContexts) {
  write_first_file();
  const int extra = std::max(1, static_cast<int>(std::thread::hardware_concurrency()) - 1);
  const int before = thread_count();
  std::vector<std::unique_ptr<Context>> contexts;
  for (int i = 0; i < 20; ++i) contexts.push_back(std::make_unique<Context>());
  work(0, INSITU_ORDER_INDEX);
  work(0, INSITU_ORDER_INDEX);
  EXPECT_LE(thread_count(), before + extra);
}

}  // namespace
}  // namespace insitu
