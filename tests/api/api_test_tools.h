// What the tests of the C API share. They see insitu.h, and nothing else of the library.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "insitu/insitu.h"
#include "temporary_folder.h"

namespace insitu::testing {

// Sanitizers keep memory and start threads of their own, and everything takes longer.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

// SplitMix64 (Steele, Lea and Flood, OOPSLA 2014): the same numbers with every standard library.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  std::uint64_t below(std::uint64_t end) { return next() % end; }
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }  // 0 <= x < 1

 private:
  std::uint64_t state_;
};

// Fisher and Yates: place i gets the item order[i].
inline std::vector<std::size_t> shuffled_order(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = i;
  SplitMix64 random(seed);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

class Context {
 public:
  explicit Context(std::uint32_t max_threads = 0, std::uint64_t max_extra_bytes = 0, std::uint32_t flags = 0,
                   std::uint32_t check_level = INSITU_CHECK_POINTERS) {
    insitu_context_desc desc;
    insitu_context_desc_init(&desc);
    desc.max_threads = max_threads;
    desc.max_extra_bytes = max_extra_bytes;
    desc.flags = flags;
    desc.check_level = check_level;
    if (insitu_context_create(&desc, &handle_) != INSITU_OK) throw std::runtime_error(insitu_error_text(nullptr));
  }
  ~Context() { insitu_context_destroy(handle_); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  operator insitu_context() const { return handle_; }
  std::string error() const { return insitu_error_text(handle_); }
  insitu_stats stats() const {
    insitu_stats stats;
    insitu_stats_init(&stats);
    EXPECT_EQ(insitu_stats_get(handle_, &stats), INSITU_OK);
    return stats;
  }

 private:
  insitu_context handle_ = nullptr;
};

// EXPECT_TRUE(works(context, insitu_commit(context))) tells the error's text when there is one.
inline ::testing::AssertionResult works(insitu_context context, insitu_status status) {
  if (status == INSITU_OK) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << insitu_status_name(status) << ": " << insitu_error_text(context);
}

// The status, and a text in which all of `words` occur.
inline ::testing::AssertionResult fails(insitu_context context, insitu_status status, insitu_status expected,
                                        std::initializer_list<std::string> words) {
  const std::string text = insitu_error_text(context);
  if (status != expected)
    return ::testing::AssertionFailure() << insitu_status_name(status) << " instead of " << insitu_status_name(expected)
                                         << "; the last text: " << text;
  for (const std::string& word : words)
    if (text.find(word) == std::string::npos)
      return ::testing::AssertionFailure() << "the text does not say '" << word << "': " << text;
  return ::testing::AssertionSuccess();
}

// The pixels of an image, compared bit for bit.
struct Picture {
  std::vector<float> color;
  std::vector<float> depth;
  std::vector<std::uint64_t> item;

  friend bool operator==(const Picture& a, const Picture& b) {
    const auto same = [](const auto& x, const auto& y) {
      return x.size() == y.size() && (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]) == 0);
    };
    return same(a.color, b.color) && same(a.depth, b.depth) && same(a.item, b.item);
  }
  // Pixels in which something was hit.
  std::size_t hits() const {
    std::size_t count = 0;
    for (const std::uint64_t i : item) count += i != ~std::uint64_t{0} ? 1 : 0;
    return count;
  }
  // Items become what stands in `name` at their place.
  template <class T>
  Picture named(const T& name) const {
    Picture result = *this;
    for (std::uint64_t& i : result.item)
      if (i != ~std::uint64_t{0}) i = static_cast<std::uint64_t>(name(i));
    return result;
  }
};

inline std::ostream& operator<<(std::ostream& out, const Picture& picture) {
  return out << "a picture of " << picture.item.size() << " pixels, " << picture.hits() << " of them hit";
}

constexpr std::uint32_t picture_channels = INSITU_CHANNEL_COLOR | INSITU_CHANNEL_DEPTH | INSITU_CHANNEL_ITEM;

inline Picture read_picture(insitu_context context, insitu_image image) {
  const auto read = [&](std::uint32_t channel, auto& values) {
    insitu_array array;
    insitu_array_init(&array);
    EXPECT_TRUE(works(context, insitu_image_channel(context, image, channel, &array)));
    values.resize(array.count * array.components);
    if (!values.empty()) std::memcpy(values.data(), array.component[0], values.size() * sizeof values[0]);
  };
  Picture picture;
  read(INSITU_CHANNEL_COLOR, picture.color);
  read(INSITU_CHANNEL_DEPTH, picture.depth);
  read(INSITU_CHANNEL_ITEM, picture.item);
  return picture;
}

inline insitu_image make_image(insitu_context context, std::uint32_t width, std::uint32_t height,
                               std::uint32_t samples = 1, std::uint32_t max_samples = 0) {
  insitu_image_desc desc;
  insitu_image_desc_init(&desc);
  desc.width = width;
  desc.height = height;
  desc.samples_per_pixel = samples;
  desc.max_samples_per_pixel = max_samples;
  desc.channels = picture_channels;
  insitu_image image = {0};
  EXPECT_TRUE(works(context, insitu_image_create(context, &desc, &image)));
  return image;
}

// A view with shadows and ambient occlusion; without a camera it is fitted to the data.
inline insitu_view make_view(insitu_context context, const insitu_camera* camera = nullptr,
                             std::uint32_t ao_samples = 2) {
  insitu_effects effects;
  insitu_effects_init(&effects);
  effects.flags = INSITU_EFFECT_SHADOWS | INSITU_EFFECT_AMBIENT_OCCLUSION;
  effects.ao_samples = ao_samples;
  insitu_view_desc desc;
  insitu_view_desc_init(&desc);
  desc.camera = camera;
  desc.effects = ao_samples == 0 ? nullptr : &effects;
  insitu_view view = {0};
  EXPECT_TRUE(works(context, insitu_view_create(context, &desc, &view)));
  return view;
}

inline insitu_geometry make_particles(insitu_context context, std::uint32_t order = INSITU_ORDER_INDEX,
                                      std::uint32_t flags = 0, const char* name = nullptr) {
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  desc.order = order;
  desc.flags = flags;
  desc.name = name;
  insitu_geometry geometry = {0};
  EXPECT_TRUE(works(context, insitu_particles_create(context, &desc, &geometry)));
  return geometry;
}

// Colours by an attribute over a fixed range.
inline insitu_style make_style(const char* attribute, double low, double high) {
  insitu_style style;
  insitu_style_init(&style);
  style.color_by = INSITU_COLOR_ATTRIBUTE;
  style.attribute = attribute;
  style.range_mode = INSITU_RANGE_FIXED;
  style.range[0] = low;
  style.range[1] = high;
  return style;
}

// Points in the unit cube, all with one radius: the smallest useful input.
struct Cloud {
  explicit Cloud(std::size_t count, std::uint64_t seed = 1) : xyz(3 * count) {
    SplitMix64 random(seed);
    for (double& x : xyz) x = random.unit();
    position = insitu_array_records(INSITU_F64, 3, xyz.data(), count, 0);
    insitu_particles_desc_init(&desc);
    desc.position = &position;
    desc.radius_default = 0.05;
  }
  Cloud(const Cloud&) = delete;
  Cloud& operator=(const Cloud&) = delete;

  std::vector<double> xyz;
  insitu_array position;
  insitu_particles_desc desc;
};

// A whole step with one set; the first status that is not OK, or that of insitu_step_end.
inline insitu_status run_step(insitu_context context, insitu_geometry geometry, const insitu_particles_desc& desc,
                              insitu_view view, insitu_image image, std::uint64_t step = 0) {
  insitu_step_begin(context, step, 0.5 * static_cast<double>(step));
  insitu_particles_update(context, geometry, &desc);
  insitu_commit(context);
  insitu_render(context, view, image);
  return insitu_step_end(context);
}

// A context with all that a step needs.
struct Studio {
  explicit Studio(std::uint32_t order = INSITU_ORDER_INDEX, std::uint32_t max_threads = 0,
                  std::uint64_t max_extra_bytes = 0)
      : context(max_threads, max_extra_bytes),
        geometry(make_particles(context, order)),
        view(make_view(context)),
        image(make_image(context, 16, 16)) {}

  insitu_status step(const insitu_particles_desc& desc, std::uint64_t number = 0) {
    return run_step(context, geometry, desc, view, image, number);
  }
  Picture picture() { return read_picture(context, image); }

  Context context;
  insitu_geometry geometry;
  insitu_view view;
  insitu_image image;
};

inline std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace insitu::testing
