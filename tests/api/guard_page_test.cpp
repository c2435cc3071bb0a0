// Arrays that begin or end at a page that must not be touched: one byte too many ends this program.
#include <gtest/gtest.h>

#include <array>

#include "api_test_tools.h"
#include "guarded_memory.h"
#include "layouts.h"

namespace insitu {
namespace {

using testing::GuardedMemory;
using testing::store;
using testing::works;

enum class Shape { packed, strided, far_strided, columns, strided_columns, rows, backwards };
constexpr Shape every_shape[] = {Shape::packed,          Shape::strided, Shape::far_strided, Shape::columns,
                                 Shape::strided_columns, Shape::rows,    Shape::backwards};
constexpr std::size_t most = 100;
constexpr std::size_t largest_stride = 4 * 8 + 40;

// One array of up to `most` items; each of its components, tables and rows is flush with a forbidden page.
class GuardedArray {
 public:
  GuardedArray() {
    for (auto& memory : memory_) memory = std::make_unique<GuardedMemory>(most * largest_stride);
  }

  insitu_array make(std::uint32_t type, std::uint32_t components, std::size_t count, Shape shape, bool at_end) {
    const std::size_t size = testing::scalar_bytes(type);
    const std::size_t item = size * components;
    if (shape == Shape::rows) return rows(type, components, count, at_end);
    if (shape == Shape::columns || shape == Shape::strided_columns) {
      const std::size_t stride = shape == Shape::columns ? size : 3 * size;
      insitu_array array = insitu_array_records(type, components, nullptr, count, static_cast<std::int64_t>(stride));
      for (std::uint32_t c = 0; c < std::min(components, 4u); ++c)
        array.component[c] = memory_[c]->flush(count == 0 ? 0 : (count - 1) * stride + size, at_end);
      return array;
    }
    const std::size_t stride = shape == Shape::strided ? item + size : shape == Shape::far_strided ? item + 40 : item;
    const std::size_t bytes = count == 0 ? 0 : (count - 1) * stride + item;
    std::byte* first = memory_[0]->flush(bytes, at_end);
    auto step = static_cast<std::int64_t>(stride);
    if (shape == Shape::backwards && count > 0) {
      first += (count - 1) * stride;
      step = -step;
    }
    return insitu_array_records(type, components, first, count, step);
  }

 private:
  // The table is flush, and so are the rows: in a block of their own without gaps.
  insitu_array rows(std::uint32_t type, std::uint32_t components, std::size_t count, bool at_end) {
    const std::size_t row = components * testing::scalar_bytes(type);
    std::byte* pool = memory_[1]->flush(count * row, at_end);
    std::byte* table = memory_[0]->flush(count * sizeof(void*), at_end);
    for (std::size_t i = 0; i < count; ++i) {
      const std::byte* start = pool + (count - 1 - i) * row;
      std::memcpy(table + i * sizeof(void*), &start, sizeof start);
    }
    insitu_array array = insitu_array_records(type, components, table, count, 0);
    array.flags = INSITU_ARRAY_ROWS;
    return array;
  }

  std::array<std::unique_ptr<GuardedMemory>, 4> memory_;
};

// A set whose arrays are all guarded.
class GuardedSet {
 public:
  struct Types {
    std::uint32_t position;
    std::uint32_t radius;  // 0: by type
    std::uint32_t type;
    std::uint32_t attribute;
  };

  void fill(std::size_t count, const Types& types, Shape shape, bool at_end) {
    arrays_[0] = position_.make(types.position, 3, count, shape, at_end);
    arrays_[1] = radius_.make(types.radius == 0 ? std::uint32_t{INSITU_F32} : types.radius, 1, count, shape, at_end);
    arrays_[2] = type_.make(types.type, 1, count, shape, at_end);
    arrays_[3] = attribute_.make(types.attribute, 4, count, shape, at_end);
    // Whole records of an odd length, as bytes.
    const bool columns = shape == Shape::columns || shape == Shape::strided_columns;
    arrays_[4] = payload_.make(INSITU_U8, 7, count, columns ? Shape::packed : shape, at_end);
    testing::SplitMix64 random(count);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::uint32_t c = 0; c < 3; ++c) store(arrays_[0], i, c, static_cast<double>(random.below(1000)));
      store(arrays_[1], i, 0, 250.0);
      store(arrays_[2], i, 0, static_cast<double>(random.below(3)));
      for (std::uint32_t c = 0; c < 4; ++c) store(arrays_[3], i, c, static_cast<double>(random.below(200)));
    }
    for (insitu_array& array : arrays_) array.flags |= INSITU_ARRAY_PERMUTABLE;

    insitu_particles_desc_init(&desc_);
    desc_.position = &arrays_[0];
    desc_.radius = types.radius == 0 ? nullptr : &arrays_[1];
    desc_.type = &arrays_[2];
    // The table of radii is read during the call only, and not past its end either.
    std::byte* table = table_.flush(sizeof(double) * 3, at_end);
    const double radii[3] = {200.0, 250.0, 300.0};
    std::memcpy(table, radii, sizeof radii);
    desc_.type_radius = reinterpret_cast<const double*>(table);
    desc_.type_radius_count = 3;
    attribute_name_ = {"attribute", &arrays_[3]};
    desc_.attributes = &attribute_name_;
    desc_.attribute_count = 1;
    payloads_ = {&arrays_[4], &arrays_[1]};
    desc_.payload = payloads_.data();
    desc_.payload_count = types.radius == 0 ? 2 : 1;
  }
  const insitu_particles_desc& desc() const { return desc_; }

 private:
  GuardedArray position_, radius_, type_, attribute_, payload_;
  GuardedMemory table_{64};
  std::array<insitu_array, 5> arrays_;
  std::array<const insitu_array*, 2> payloads_;
  insitu_attribute attribute_name_;
  insitu_particles_desc desc_;
};

// What reads arrays: the checks of every level, the build, the colours, rays of every kind, and the way back.
class Reader {
 public:
  explicit Reader(std::uint32_t order)
      : context_(1, 0, 0, INSITU_CHECK_CHECKSUM),
        order_(order),
        geometry_(testing::make_particles(context_, order,
                                          order == INSITU_ORDER_PERMUTE ? INSITU_PARTICLES_KEEP_PERMUTATION : 0)),
        view_(testing::make_view(context_, nullptr, 1)),
        image_(testing::make_image(context_, 8, 8)) {
    insitu_style style;
    insitu_style_init(&style);
    style.color_by = INSITU_COLOR_ATTRIBUTE;
    style.attribute = "attribute";  // its length, over a range that has to be found
    EXPECT_TRUE(works(context_, insitu_geometry_set_style(context_, geometry_, &style)));
  }

  // False when a status was not OK.
  bool read(const insitu_particles_desc& desc) {
    insitu_step_begin(context_, 0, 0.0);
    insitu_particles_update(context_, geometry_, &desc);
    insitu_commit(context_);
    insitu_view_fit(context_, view_, 1.0);
    insitu_render(context_, view_, image_);
    if (order_ == INSITU_ORDER_PERMUTE) insitu_particles_restore_order(context_, geometry_);
    return insitu_step_end(context_) == INSITU_OK;
  }
  std::size_t hits() const { return testing::read_picture(context_, image_).hits(); }
  std::string error() const { return context_.error(); }

 private:
  testing::Context context_;
  std::uint32_t order_;
  insitu_geometry geometry_;
  insitu_view view_;
  insitu_image image_;
};

void read_all_shapes(std::uint32_t order) {
  constexpr GuardedSet::Types every_types[] = {
      {INSITU_F32, INSITU_F32, INSITU_U8, INSITU_F32},
      {INSITU_F64, INSITU_F64, INSITU_I32, INSITU_F64},
      {INSITU_U32, 0, INSITU_U64, INSITU_I32},
      {INSITU_I32, 0, INSITU_I64, INSITU_U8},
  };
  const auto set = std::make_unique<GuardedSet>();
  Reader reader(order);
  for (const auto& types : every_types) {
    for (const Shape shape : every_shape) {
      for (const bool at_end : {true, false}) {
        // Sanitized programs are slow: there, around the sizes of vectors and leaves.
        for (std::size_t count = 0; count <= most; count += testing::sanitized && count > 34 ? 13 : 1) {
          set->fill(count, types, shape, at_end);
          ASSERT_TRUE(reader.read(set->desc())) << reader.error() << "; position type " << types.position << ", shape "
                                                << static_cast<int>(shape) << ", " << count << " particles";
          ASSERT_EQ(reader.hits() > 0, count > 0)
              << "position type " << types.position << ", shape " << static_cast<int>(shape) << ", " << count;
        }
      }
    }
  }
}

TEST(GuardPages, Index) { read_all_shapes(INSITU_ORDER_INDEX); }
TEST(GuardPages, Permute) { read_all_shapes(INSITU_ORDER_PERMUTE); }
TEST(GuardPages, Copy) { read_all_shapes(INSITU_ORDER_COPY); }

// The pages do what they are there for.
TEST(GuardPages, OneByteTooManyIsFatal) {
  const GuardedMemory memory(1);
  const auto touch = [](const std::byte* address) { *const_cast<volatile std::byte*>(address); };
  EXPECT_DEATH(touch(memory.end()), "");
  EXPECT_DEATH(touch(memory.begin() - 1), "");
  touch(memory.end() - 1);
}

}  // namespace
}  // namespace insitu
