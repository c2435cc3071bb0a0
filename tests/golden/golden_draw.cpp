// Hands a scene over to the C API in one of the ways that simulations do.
#include <cstring>
#include <memory>
#include <stdexcept>

#include "golden_scene.h"

namespace insitu::golden {
namespace {

class Context {
 public:
  explicit Context(std::uint32_t threads) {
    insitu_context_desc desc;
    insitu_context_desc_init(&desc);
    desc.max_threads = threads;
    if (insitu_context_create(&desc, &context_) != INSITU_OK) throw std::runtime_error(insitu_error_text(nullptr));
  }
  ~Context() { insitu_context_destroy(context_); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  insitu_context get() const { return context_; }
  void expect_ok(insitu_status status) const {
    if (status != INSITU_OK) throw std::runtime_error(insitu_error_text(context_));
  }

 private:
  insitu_context context_ = nullptr;
};

// The arrays of a set in memory of their own, laid out and typed as the variant says.
class SetArrays {
 public:
  SetArrays(const Set& set, const Variant& variant) : count_(set.count()), variant_(variant) {
    position = vectors(set.x);
    radius = scalars(set.radius);
    value = scalars(set.value);
    vector = set.vector.empty() ? insitu_array{} : vectors(set.vector);
    type = plain(INSITU_I32, set.type.data(), count_ * sizeof(std::int32_t));
  }

  insitu_array position;
  insitu_array radius;
  insitu_array value;
  insitu_array vector;  // struct_size 0: there is none
  insitu_array type;

 private:
  std::size_t scalar_size() const { return variant_.f32 ? 4 : 8; }
  std::uint32_t scalar_type() const { return variant_.f32 ? INSITU_F32 : INSITU_F64; }

  std::byte* allocate(std::size_t bytes) {
    // Room for doubles keeps every array aligned.
    memory_.push_back(std::make_unique<double[]>(bytes / sizeof(double) + 1));
    return reinterpret_cast<std::byte*>(memory_.back().get());
  }
  void put(std::byte* at, double value) const {
    if (variant_.f32) {
      const auto narrow = static_cast<float>(value);
      std::memcpy(at, &narrow, sizeof narrow);
    } else {
      std::memcpy(at, &value, sizeof value);
    }
  }
  insitu_array permutable(insitu_array array) const {
    if (variant_.order == INSITU_ORDER_PERMUTE) array.flags |= INSITU_ARRAY_PERMUTABLE;
    return array;
  }
  insitu_array plain(std::uint32_t type_id, const void* data, std::size_t bytes) {
    std::byte* copy = allocate(bytes);
    if (bytes > 0) std::memcpy(copy, data, bytes);
    return permutable(insitu_array_records(type_id, 1, copy, count_, 0));
  }
  insitu_array scalars(const std::vector<double>& values) {
    const std::size_t stride = variant_.layout == Layout::strided ? 3 * scalar_size() : scalar_size();
    std::byte* first = allocate(count_ * stride);
    for (std::size_t i = 0; i < count_; ++i) put(first + i * stride, values[i]);
    return permutable(insitu_array_records(scalar_type(), 1, first, count_, static_cast<std::int64_t>(stride)));
  }
  insitu_array vectors(const std::vector<double>& values) {
    const std::size_t size = scalar_size();
    if (variant_.layout == Layout::columns) {
      std::byte* columns[3];
      for (std::size_t c = 0; c < 3; ++c) {
        columns[c] = allocate(count_ * size);
        for (std::size_t i = 0; i < count_; ++i) put(columns[c] + i * size, values[3 * i + c]);
      }
      return permutable(insitu_array_columns(scalar_type(), columns[0], columns[1], columns[2], count_));
    }
    const std::size_t stride = variant_.layout == Layout::strided ? 7 * size : 3 * size;
    std::byte* first = allocate(count_ * stride);
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t c = 0; c < 3; ++c) put(first + i * stride + c * size, values[3 * i + c]);
    return permutable(insitu_array_records(scalar_type(), 3, first, count_, static_cast<std::int64_t>(stride)));
  }

  std::size_t count_;
  Variant variant_;
  std::vector<std::unique_ptr<double[]>> memory_;
};

insitu_geometry add_set(const Context& context, const Set& set, const SetArrays& arrays, const Variant& variant) {
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  desc.order = variant.order;
  desc.position = &arrays.position;
  desc.radius = &arrays.radius;
  desc.type = &arrays.type;
  const insitu_attribute attributes[] = {{"value", &arrays.value}, {"vector", &arrays.vector}};
  desc.attributes = attributes;
  desc.attribute_count = arrays.vector.struct_size != 0 ? 2 : 1;
  insitu_geometry geometry;
  context.expect_ok(insitu_particles_create(context.get(), &desc, &geometry));

  insitu_style style;
  insitu_style_init(&style);
  if (set.color_by != nullptr) {
    style.color_by = INSITU_COLOR_ATTRIBUTE;
    style.attribute = set.color_by;
    style.colormap = set.colormap;
  }
  if (!set.own_colors.empty()) {
    insitu_colormap_desc colors;
    insitu_colormap_desc_init(&colors);
    colors.kind = INSITU_COLORMAP_CATEGORICAL;
    colors.rgba = set.own_colors.data();
    colors.count = set.own_colors.size() / 4;
    context.expect_ok(insitu_colormap_create(context.get(), &colors, &style.own_map));
  }
  for (int c = 0; c < 3; ++c) style.color[c] = set.color[c];
  style.opacity = set.opacity;
  context.expect_ok(insitu_geometry_set_style(context.get(), geometry, &style));
  return geometry;
}

void add_glyphs(const Context& context, const Glyphs& glyphs, insitu_geometry set) {
  insitu_geometry geometry;
  if (glyphs.cell.struct_size != 0) context.expect_ok(insitu_particles_set_cell(context.get(), set, &glyphs.cell));
  if (!glyphs.filter.empty()) {
    insitu_filter filter;
    insitu_filter_init(&filter);
    filter.term_count = static_cast<std::uint32_t>(glyphs.filter.size());
    filter.terms = glyphs.filter.data();
    context.expect_ok(insitu_particles_set_filter(context.get(), set, &filter));
  }
  if (glyphs.bonds > 0.0) {
    insitu_bonds_desc bonds;
    insitu_bonds_desc_init(&bonds);
    bonds.flags = INSITU_BONDS_PERIODIC;
    bonds.particles = set;
    bonds.cutoff = glyphs.bonds;
    bonds.radius = glyphs.bond_radius;
    context.expect_ok(insitu_bonds_create(context.get(), &bonds, &geometry));
  }
  if (glyphs.arrows > 0.0) {
    insitu_vectors_desc vectors;
    insitu_vectors_desc_init(&vectors);
    vectors.particles = set;
    vectors.attribute = "vector";
    vectors.scale = glyphs.arrows;
    vectors.radius = glyphs.arrow_radius;
    context.expect_ok(insitu_vectors_create(context.get(), &vectors, &geometry));
  }
}

}  // namespace

std::string name_of(const Variant& variant) {
  constexpr const char* layouts[] = {"records", "columns", "strided"};
  constexpr const char* orders[] = {"index", "permute", "copy"};
  return std::string(variant.f32 ? "f32" : "f64") + "_" + layouts[static_cast<int>(variant.layout)] + "_" +
         orders[variant.order] + "_" + std::to_string(variant.threads) + "_threads";
}

std::vector<float> draw(const Scene& scene, const Variant& variant, const std::string& path) {
  const Context context(variant.threads);
  insitu_view_desc view_desc;
  insitu_view_desc_init(&view_desc);
  view_desc.camera = &scene.camera;
  view_desc.effects = &scene.effects;
  view_desc.lights = scene.lights.data();
  view_desc.light_count = static_cast<std::uint32_t>(scene.lights.size());
  for (int c = 0; c < 4; ++c) view_desc.background[c] = scene.background[c];
  insitu_view view;
  context.expect_ok(insitu_view_create(context.get(), &view_desc, &view));
  insitu_image_desc image_desc;
  insitu_image_desc_init(&image_desc);
  image_desc.width = width;
  image_desc.height = height;
  image_desc.samples_per_pixel = scene.samples_per_pixel;
  insitu_image image;
  context.expect_ok(insitu_image_create(context.get(), &image_desc, &image));

  context.expect_ok(insitu_step_begin(context.get(), 0, 0.0));
  std::vector<std::unique_ptr<SetArrays>> arrays;
  for (const Set& set : scene.sets) {
    arrays.push_back(std::make_unique<SetArrays>(set, variant));
    add_glyphs(context, scene.glyphs, add_set(context, set, *arrays.back(), variant));
  }
  context.expect_ok(insitu_commit(context.get()));
  context.expect_ok(insitu_render(context.get(), view, image));
  if (!path.empty()) context.expect_ok(insitu_image_write(context.get(), image, path.c_str()));
  insitu_array channel;
  insitu_array_init(&channel);
  context.expect_ok(insitu_image_channel(context.get(), image, INSITU_CHANNEL_COLOR, &channel));
  std::vector<float> pixels(4 * static_cast<std::size_t>(width) * height);
  if (channel.count * channel.components != pixels.size()) throw std::runtime_error("an image of another size");
  std::memcpy(pixels.data(), channel.component[0], pixels.size() * sizeof(float));
  context.expect_ok(insitu_step_end(context.get()));
  return pixels;
}

}  // namespace insitu::golden
