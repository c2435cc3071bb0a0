// Memory that runs out, at every allocation of a step: one error, nothing lost, and the next step works.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <functional>
#include <limits>
#include <new>

#include "api_test_tools.h"

// ------------------------------------------------------------------------------------------- an allocator that fails
// -- Replaces operator new for this program and all its libraries.

namespace {

constexpr long never = std::numeric_limits<long>::max();
std::atomic<bool> armed{false};
std::atomic<long> until_failure{never};
std::atomic<bool> fails_for_good{false};
std::atomic<bool> only_own_code{false};  // not what is allocated by libraries on behalf of ours
std::atomic<long> failures{0};

// Embree 3.13 does not survive a failing operator new in its own code: heap corruption, or an assertion of Debian's
// build. OpenImageIO 2.4 allocates in functions that are noexcept.
bool may_fail(const void* caller) {
  Dl_info info;
  if (dladdr(caller, &info) == 0) return true;
  const auto is_of = [&info](const char* library) { return std::strstr(info.dli_fname, library) != nullptr; };
  return only_own_code ? is_of("libinsitu") : !is_of("libembree");
}

bool is_refused(const void* caller) {
  if (!armed.load(std::memory_order_relaxed) || !may_fail(caller)) return false;
  const long left = until_failure.fetch_sub(1);
  if (left > 0 || (left < 0 && !fails_for_good.load())) return false;
  ++failures;
  return true;
}

void* allocate(std::size_t bytes, std::size_t alignment, const void* caller) {
  if (is_refused(caller)) return nullptr;
  if (alignment <= alignof(std::max_align_t)) return std::malloc(bytes == 0 ? 1 : bytes);
  return std::aligned_alloc(alignment, (bytes + alignment) / alignment * alignment);
}

void* allocate_or_throw(std::size_t bytes, std::size_t alignment, const void* caller) {
  void* memory = allocate(bytes, alignment, caller);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

// Not inline: compilers that see free() behind a delete warn of a mismatch with new.
__attribute__((noinline)) void release(void* memory) noexcept { std::free(memory); }

}  // namespace

void* operator new(std::size_t bytes) { return allocate_or_throw(bytes, 1, __builtin_return_address(0)); }
void* operator new[](std::size_t bytes) { return allocate_or_throw(bytes, 1, __builtin_return_address(0)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return allocate_or_throw(bytes, static_cast<std::size_t>(alignment), __builtin_return_address(0));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
  return allocate_or_throw(bytes, static_cast<std::size_t>(alignment), __builtin_return_address(0));
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return allocate(bytes, 1, __builtin_return_address(0));
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
  return allocate(bytes, 1, __builtin_return_address(0));
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete[](void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { release(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { release(memory); }

namespace insitu {
namespace {

using testing::Cloud;
using testing::works;

// Runs `body` with the allocation number `n` failing, and, `for_good`, all after it. True when it came to that.
template <class Body>
bool with_failure(long n, bool for_good, const Body& body) {
  until_failure = n;
  fails_for_good = for_good;
  failures = 0;
  armed = true;
  body();
  armed = false;
  return failures > 0;
}

// A step with all that allocates: two sets in two orders, colours, effects and a report.
class Scene {
 public:
  explicit Scene(std::uint32_t order, std::uint32_t max_threads = 1)
      : context_(max_threads), one_(300, 1), two_(200, 2), values_(300) {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = static_cast<double>(i);
    value_ = insitu_array_records(INSITU_F64, 1, values_.data(), values_.size(), 0);
    attribute_ = {"a name that is too long to be stored in place", &value_};
    one_.desc.attributes = &attribute_;
    one_.desc.attribute_count = 1;
    one_.position.flags = two_.position.flags = value_.flags = INSITU_ARRAY_PERMUTABLE;
    first_ = testing::make_particles(context_, order, 0, "the first of two sets of particles");
    second_ = testing::make_particles(context_, INSITU_ORDER_INDEX, 0, "the second of two sets of particles");
    const insitu_style style = testing::make_style(attribute_.name, 0.0, 300.0);
    EXPECT_TRUE(works(context_, insitu_geometry_set_style(context_, first_, &style)));
    view_ = testing::make_view(context_);
    image_ = testing::make_image(context_, 20, 20);
    report_name_ = folder_.file("report.jsonl");
    EXPECT_TRUE(works(context_, insitu_context_set_report(context_, report_name_.c_str())));
    EXPECT_TRUE(works(context_, insitu_context_set_log(context_, note, &errors_, INSITU_LOG_ERROR)));
  }

  insitu_status step() {
    errors_ = 0;
    insitu_step_begin(context_, 1, 0.5);
    insitu_particles_update(context_, first_, &one_.desc);
    insitu_particles_update(context_, second_, &two_.desc);
    insitu_commit(context_);
    insitu_render(context_, view_, image_);
    return insitu_step_end(context_);
  }
  insitu_status write(const char* name) {
    errors_ = 0;
    return insitu_image_write(context_, image_, (folder_.file(name)).c_str());
  }
  std::vector<std::string> files() const { return folder_.names(); }
  std::vector<double> contents() const {
    std::vector<double> all = one_.xyz;
    all.insert(all.end(), values_.begin(), values_.end());
    all.insert(all.end(), two_.xyz.begin(), two_.xyz.end());
    return all;
  }
  testing::Picture picture() const {
    testing::Picture picture = testing::read_picture(context_, image_);
    picture.item.clear();  // under PERMUTE places change from step to step
    return picture;
  }
  std::uint64_t owned_bytes() const { return context_.stats().owned_bytes; }
  int errors() const { return errors_; }
  std::string text() const { return context_.error(); }

 private:
  static void note(void* user, std::int32_t, const char*) { ++*static_cast<int*>(user); }

  testing::TemporaryFolder folder_;
  testing::Context context_;
  Cloud one_;
  Cloud two_;
  std::vector<double> values_;
  insitu_array value_;
  insitu_attribute attribute_;
  insitu_geometry first_;
  insitu_geometry second_;
  insitu_view view_;
  insitu_image image_;
  std::string report_name_;
  int errors_ = 0;
};

void fail_everywhere(std::uint32_t order, std::uint32_t max_threads, bool for_good) {
  Scene scene(order, max_threads);
  ASSERT_EQ(scene.step(), INSITU_OK) << scene.text();
  const testing::Picture picture = scene.picture();
  const std::uint64_t owned = scene.owned_bytes();
  std::vector<double> sorted = scene.contents();
  const std::vector<double> before = sorted;
  std::sort(sorted.begin(), sorted.end());

  long n = 0;
  long told = 0;
  for (bool failed = true; failed; ++n) {
    SCOPED_TRACE(n);
    insitu_status status = INSITU_OK;
    failed = with_failure(n, for_good, [&] { status = scene.step(); });
    if (status == INSITU_OK) {
      // Some code can do without.
      EXPECT_EQ(scene.errors(), 0);
      EXPECT_EQ(scene.picture(), picture);
    } else {
      ++told;
      EXPECT_EQ(status, INSITU_ERROR_OUT_OF_MEMORY) << scene.text();
      EXPECT_EQ(scene.errors(), 1);
      if (!for_good) {
        EXPECT_NE(scene.text(), "");
      }
    }
    ASSERT_EQ(scene.step(), INSITU_OK) << "the next step: " << scene.text();
    ASSERT_EQ(scene.picture(), picture);
    ASSERT_EQ(scene.owned_bytes(), owned) << "bytes come back";
    std::vector<double> now = scene.contents();
    if (order != INSITU_ORDER_PERMUTE) {
      ASSERT_EQ(now, before);
    }
    std::sort(now.begin(), now.end());
    ASSERT_EQ(now, sorted) << "every value is there once";
  }
  EXPECT_GT(n, 50) << "there was something to fail";
  EXPECT_GT(told, 20);
}

TEST(Allocation, OneFailsInAnIndexedStep) { fail_everywhere(INSITU_ORDER_INDEX, 1, false); }
TEST(Allocation, OneFailsInAPermutedStep) { fail_everywhere(INSITU_ORDER_PERMUTE, 1, false); }
TEST(Allocation, OneFailsInACopiedStep) { fail_everywhere(INSITU_ORDER_COPY, 2, false); }
TEST(Allocation, AllFailFromSomePointOn) { fail_everywhere(INSITU_ORDER_INDEX, 1, true); }
TEST(Allocation, AllFailFromSomePointOnPermuted) { fail_everywhere(INSITU_ORDER_PERMUTE, 1, true); }

// A file that could not be written for lack of memory is not there, and its temporary file neither.
TEST(Allocation, Files) {
  Scene scene(INSITU_ORDER_INDEX);
  ASSERT_EQ(scene.step(), INSITU_OK) << scene.text();
  only_own_code = true;
  for (const char* name : {"picture_{step:9}.png", "picture_{step:9}.exr"}) {
    insitu_status status = INSITU_ERROR_OUT_OF_MEMORY;
    long n = 0;
    for (; status != INSITU_OK && n < 1000; ++n) {
      const std::size_t files = scene.files().size();
      with_failure(n, false, [&] { status = scene.write(name); });
      if (status == INSITU_OK) continue;
      EXPECT_EQ(status, INSITU_ERROR_OUT_OF_MEMORY) << scene.text();
      EXPECT_EQ(scene.errors(), 1);
      EXPECT_EQ(scene.files().size(), files);
    }
    EXPECT_GT(n, 3);
    EXPECT_LT(n, 1000);
  }
  only_own_code = false;
  EXPECT_EQ(scene.files().size(), 3u) << "two pictures and the report";
}

// Calls that make something: all or nothing.
TEST(Allocation, Objects) {
  const testing::Context context;
  const double colors[8] = {0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  insitu_colormap_desc colormap_desc;
  insitu_colormap_desc_init(&colormap_desc);
  colormap_desc.rgba = colors;
  colormap_desc.count = 2;
  insitu_image_desc image_desc;
  insitu_image_desc_init(&image_desc);
  image_desc.width = image_desc.height = 32;
  insitu_particles_desc particles_desc;
  insitu_particles_desc_init(&particles_desc);
  particles_desc.name = "a name that is too long to be stored in place";
  insitu_light light;
  insitu_light_init(&light);
  insitu_view_desc view_desc;
  insitu_view_desc_init(&view_desc);
  view_desc.lights = &light;
  view_desc.light_count = 1;

  std::uint64_t id = 0;
  const std::function<insitu_status()> makers[] = {
      [&] { return insitu_particles_create(context, &particles_desc, reinterpret_cast<insitu_geometry*>(&id)); },
      [&] { return insitu_view_create(context, &view_desc, reinterpret_cast<insitu_view*>(&id)); },
      [&] { return insitu_image_create(context, &image_desc, reinterpret_cast<insitu_image*>(&id)); },
      [&] { return insitu_colormap_create(context, &colormap_desc, reinterpret_cast<insitu_colormap*>(&id)); },
      [&] { return insitu_context_set_report(context, "a name that is too long to be stored in place"); },
  };
  for (const auto& make : makers) {
    for (const bool for_good : {false, true}) {
      const std::uint64_t owned = context.stats().owned_bytes;
      long n = 0;
      for (insitu_status status = INSITU_ERROR_OUT_OF_MEMORY; status != INSITU_OK && n < 100; ++n) {
        id = 99;
        with_failure(n, for_good, [&] { status = make(); });
        if (status == INSITU_OK) continue;
        EXPECT_EQ(status, INSITU_ERROR_OUT_OF_MEMORY);
        if (id != 99) {
          EXPECT_EQ(id, 0u);
        }
        EXPECT_EQ(context.stats().owned_bytes, owned);
      }
      EXPECT_LT(n, 100);
      if (!for_good) {
        EXPECT_GT(n, 1);
      }
    }
  }
  EXPECT_TRUE(works(context, insitu_context_set_report(context, nullptr)));
}

TEST(Allocation, Contexts) {
  for (const bool for_good : {false, true}) {
    insitu_status status = INSITU_ERROR_OUT_OF_MEMORY;
    long n = 0;
    for (; status != INSITU_OK && n < 100; ++n) {
      insitu_context context = nullptr;
      with_failure(n, for_good, [&] { status = insitu_context_create(nullptr, &context); });
      if (status == INSITU_OK) {
        insitu_context_destroy(context);
      } else {
        EXPECT_EQ(status, INSITU_ERROR_OUT_OF_MEMORY);
        EXPECT_EQ(context, nullptr);
      }
    }
    EXPECT_GT(n, 1);
    EXPECT_LT(n, 100);
  }
}

// The first error of a step is kept, and its text told, also when there is no memory to write the text down.
TEST(Allocation, WhatIsWrongIsToldWithoutMemory) {
  testing::Studio studio;
  insitu_array array;
  insitu_array_init(&array);
  const insitu_array bad = insitu_array_records(INSITU_F64, 3, nullptr, 5, 0);
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  desc.position = &bad;
  insitu_status first = INSITU_OK;
  insitu_status last = INSITU_OK;
  with_failure(0, true, [&] {
    insitu_step_begin(studio.context, 0, 0.0);
    first = insitu_particles_update(studio.context, studio.geometry, &desc);
    last = insitu_step_end(studio.context);
  });
  EXPECT_NE(first, INSITU_OK);
  EXPECT_EQ(last, first);
  const Cloud cloud(10);
  EXPECT_TRUE(works(studio.context, studio.step(cloud.desc)));

  insitu_array_report report;
  insitu_array_report_init(&report);
  with_failure(0, true, [&] { first = insitu_array_check(&bad, INSITU_USE_POSITION, &report); });
  EXPECT_NE(first, INSITU_OK);
  EXPECT_EQ(report.status, first);
}

}  // namespace
}  // namespace insitu
