// Calls of a context about cells, bonds and vectors.
#include "api/context.h"
#include "core/error.h"
#include "core/stopwatch.h"

namespace insitu {

GeometryObject& Context::particle_set(std::uint64_t id) {
  GeometryObject& geometry = geometries_.get(id);
  if (geometry.glyphs) throw Error(INSITU_ERROR_INVALID_HANDLE, "this geometry is not a set of particles");
  return geometry;
}

void Context::set_cell(std::uint64_t id, const insitu_cell* cell) {
  GeometryObject& geometry = particle_set(id);
  geometry.changed = true;
  if (cell == nullptr) {
    geometry.cell.reset();
    return;
  }
  geometry.cell = read_cell(*cell);
}

// The bonds or vectors that `make` describes, of a set that exists.
std::uint64_t Context::create_glyphs(std::uint64_t set, const std::string& name,
                                     const std::function<void(GeometryObject&)>& make) {
  particle_set(set);
  auto object = std::make_unique<GeometryObject>(name, ParticleOrder::index, false);
  object->glyphs = std::make_unique<Glyphs>(set);
  make(*object);
  scene_dirty_ = true;
  if (check_level_ >= INSITU_CHECK_CHECKSUM) object->checksum = checksum_of(*object);
  return geometries_.insert(std::move(object));
}

std::uint64_t Context::create_bonds(const insitu_bonds_desc& desc) {
  const std::string name = desc.name == nullptr ? "bonds" : desc.name;
  const BondSettings settings = read_bonds(desc, name);
  if (settings.by_pairs) need_step("insitu_bonds_create with pairs");
  return create_glyphs(desc.particles.id, name, [&](GeometryObject& object) { object.glyphs->bonds = settings; });
}

void Context::update_bonds(std::uint64_t id, const insitu_bonds_desc& desc) {
  GeometryObject& object = geometries_.get(id);
  if (!object.glyphs || !object.glyphs->bonds) throw Error(INSITU_ERROR_INVALID_HANDLE, "this geometry is not bonds");
  const BondSettings settings = read_bonds(desc, object.particles.name());
  if (settings.by_pairs) need_step("insitu_bonds_update with pairs");
  scene_dirty_ = true;
  object.glyphs->release();
  object.glyphs->bonds = settings;
  if (check_level_ >= INSITU_CHECK_CHECKSUM) object.checksum = checksum_of(object);
}

std::uint64_t Context::create_vectors(const insitu_vectors_desc& desc) {
  const std::string name = desc.name == nullptr ? "vectors" : desc.name;
  VectorSettings settings = read_vectors(desc, name);
  return create_glyphs(desc.particles.id, name, [&](GeometryObject& object) {
    object.style.by_attribute = true;
    object.style.attribute = settings.attribute;
    object.style_is_default = true;
    object.glyphs->vectors = std::move(settings);
  });
}

void Context::update_vectors(std::uint64_t id, const insitu_vectors_desc& desc) {
  GeometryObject& object = geometries_.get(id);
  if (!object.glyphs || !object.glyphs->vectors)
    throw Error(INSITU_ERROR_INVALID_HANDLE, "this geometry is not vectors");
  VectorSettings settings = read_vectors(desc, object.particles.name());
  scene_dirty_ = true;
  object.glyphs->release();
  if (object.style_is_default) object.style.attribute = settings.attribute;
  object.glyphs->vectors = std::move(settings);
}

// By whose style the bonds or vectors are coloured.
const Style& Context::glyph_style(const GeometryObject& object) {
  const Glyphs& glyphs = *object.glyphs;
  const bool of_ends = glyphs.bonds && (glyphs.bonds->flags & INSITU_BONDS_OWN_STYLE) == 0;
  return of_ends ? geometries_.get(glyphs.set()).style : object.style;
}

bool Context::is_drawn(const GeometryObject& object) {
  return object.glyphs ? object.glyphs->takes_part() && particle_set(object.glyphs->set()).particles.is_bound()
                       : object.particles.is_bound();
}

void Context::check_glyphs(const GeometryObject& object) {
  const Particles& particles = particle_set(object.glyphs->set()).particles;
  object.glyphs->check(object.particles.name(), particles);
  const Style& style = glyph_style(object);
  Colors::check(style, particles);
  colormap_of(style);
}

void Context::build_cell(GeometryObject& geometry) {
  const Stopwatch watch;
  workers_.run([&] { geometry.shown_cell.build(budget_, geometry.cell, geometry.particles); });
  report_.build_s += watch.seconds();
}

void Context::build_glyphs(GeometryObject& object) {
  const Stopwatch watch;
  const GeometryObject& set = particle_set(object.glyphs->set());
  const std::string bad =
      workers_.run([&] { return object.glyphs->build(budget_, set.particles, set.shown_cell.display()); });
  report_.build_s += watch.seconds();
  report_.bytes_borrowed += object.glyphs->borrowed_bytes();
  if (!bad.empty()) warn(object.particles.name() + ": " + bad);
}

// What shows an object, each at its place.
void Context::each_shown(const GeometryObject& object,
                         const std::function<void(const Geometry&, const glm::dvec3&)>& action) {
  if (!object.glyphs) {
    if (object.particles.shown_count() != 0) object.shown_cell.each_instance(object.particles, action);
    return;
  }
  const GeometryObject& set = particle_set(object.glyphs->set());
  set.shown_cell.each_copy([&](const glm::dvec3& shift) { action(object.glyphs->geometry(), shift); });
}

// Sets first, then the outlines of their cells, then what stands on them.
void Context::fill_scene() {
  const auto add = [this](const GeometryObject& object, const Particles& particles, const Style& style) {
    const Colors colors(style, particles, colormap_of(style));
    each_shown(object, [&](const Geometry& geometry, const glm::dvec3& shift) { scene_.add(geometry, colors, shift); });
  };
  geometries_.for_each([&](std::uint64_t, GeometryObject& object) {
    if (object.glyphs || !is_drawn(object)) return;
    if (!object.particles.is_built())
      throw Error(INSITU_ERROR_WRONG_STATE, object.particles.name() + ": updated after insitu_commit; commit again");
    add(object, object.particles, object.style);
  });
  geometries_.for_each([&](std::uint64_t, GeometryObject& object) {
    if (object.glyphs || !is_drawn(object) || object.shown_cell.outline() == nullptr) return;
    Style style;
    style.color = object.shown_cell.display()->outline_color;
    const Colors colors(style, object.particles, colormap_of(style));
    object.shown_cell.each_copy(
        [&](const glm::dvec3& shift) { scene_.add(*object.shown_cell.outline(), colors, shift); });
  });
  geometries_.for_each([&](std::uint64_t, GeometryObject& object) {
    if (!object.glyphs || !is_drawn(object)) return;
    if (!object.glyphs->is_built())
      throw Error(INSITU_ERROR_WRONG_STATE, object.particles.name() + ": updated after insitu_commit; commit again");
    add(object, particle_set(object.glyphs->set()).particles, glyph_style(object));
  });
}

void Context::destroy_glyphs_of(std::uint64_t set) {
  std::vector<std::uint64_t> ids;
  geometries_.for_each([&](std::uint64_t id, const GeometryObject& object) {
    if (object.glyphs && object.glyphs->set() == set) ids.push_back(id);
  });
  for (const std::uint64_t id : ids) geometries_.remove(id);
}

}  // namespace insitu
