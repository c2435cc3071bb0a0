#include "api/particles_input.h"

#include <cmath>

#include "api/descriptor.h"

namespace insitu {
namespace {

class Reader {
 public:
  Reader(std::string set_name, ParticleOrder order) : set_name_(std::move(set_name)), order_(order) {}

  [[noreturn]] void refuse(const std::string& text) const {
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, set_name_ + ": " + text);
  }

  kernels::ArrayView view(const insitu_array* array, std::uint32_t use, const std::string& name) {
    if (array == nullptr) refuse(name + " is NULL");
    const std::string what = set_name_ + ": " + name;
    const insitu_array copy = copy_of(array, what);
    if (order_ == ParticleOrder::permute && (copy.flags & INSITU_ARRAY_PERMUTABLE) == 0)
      throw Error(INSITU_ERROR_INVALID_ARGUMENT,
                  what + " is not marked INSITU_ARRAY_PERMUTABLE, which INSITU_ORDER_PERMUTE needs of every array");
    if (use != INSITU_USE_POSITION && copy.count != count_)
      throw Error(INSITU_ERROR_INVALID_ARGUMENT,
                  what + " has " + std::to_string(copy.count) + " items, position has " + std::to_string(count_));
    kernels::ArrayView checked = checked_view(copy, use, what);
    if (use == INSITU_USE_POSITION) count_ = copy.count;
    return checked;
  }

 private:
  static insitu_array copy_of(const insitu_array* array, const std::string& what) {
    try {
      return copy_in(array, "insitu_array");
    } catch (const Error& error) {
      throw Error(error.status(), what + ": " + error.what());
    }
  }

  std::string set_name_;
  ParticleOrder order_;
  std::uint64_t count_ = 0;
};

void read_lattice(const insitu_particles_desc& desc, const Reader& reader, ParticleArrays& arrays) {
  const bool floats = arrays.position.type == kernels::Scalar::f32 || arrays.position.type == kernels::Scalar::f64;
  const double* origin = desc.position_origin;
  if (floats) {
    if ((desc.position_scale != 0.0 && desc.position_scale != 1.0) || origin[0] != 0.0 || origin[1] != 0.0 ||
        origin[2] != 0.0)
      reader.refuse("position_scale and position_origin are for integer positions only");
    return;
  }
  arrays.position_scale = desc.position_scale == 0.0 ? 1.0 : desc.position_scale;
  if (!(arrays.position_scale > 0.0 && std::isfinite(arrays.position_scale)))
    reader.refuse("position_scale is negative or not finite");
  for (int c = 0; c < 3; ++c) {
    if (!std::isfinite(origin[c])) reader.refuse("position_origin is not finite");
    arrays.position_origin[c] = origin[c];
  }
}

void read_radii(const insitu_particles_desc& desc, Reader& reader, ParticleArrays& arrays) {
  if (desc.radius != nullptr) arrays.radius = reader.view(desc.radius, INSITU_USE_RADIUS, "radius");
  if (desc.type != nullptr) arrays.type = reader.view(desc.type, INSITU_USE_TYPE, "type");
  if (desc.type_radius_count != 0) {
    if (desc.type_radius == nullptr) reader.refuse("type_radius is NULL but type_radius_count is not 0");
    if (desc.type == nullptr) reader.refuse("type_radius needs a type array");
    arrays.type_radius.assign(desc.type_radius, desc.type_radius + desc.type_radius_count);
  }
  arrays.radius_default = desc.radius_default;
  if (!(arrays.radius_default >= 0.0 && std::isfinite(arrays.radius_default)))
    reader.refuse("radius_default is negative or not finite");
  arrays.radius_scale = desc.radius_scale == 0.0 ? 1.0 : desc.radius_scale;
  arrays.treelet_share = desc.treelet_share;
  if (!(arrays.treelet_share >= 0.0 && std::isfinite(arrays.treelet_share)))
    reader.refuse("treelet_share is negative or not finite");
  if (!(arrays.radius_scale > 0.0 && std::isfinite(arrays.radius_scale)))
    reader.refuse("radius_scale is negative or not finite");
}

void read_attributes(const insitu_particles_desc& desc, Reader& reader, ParticleArrays& arrays) {
  if (desc.attribute_count != 0 && desc.attributes == nullptr)
    reader.refuse("attributes is NULL but attribute_count is not 0");
  if (desc.payload_count != 0 && desc.payload == nullptr) reader.refuse("payload is NULL but payload_count is not 0");
  for (std::uint64_t i = 0; i < desc.attribute_count; ++i) {
    const insitu_attribute& attribute = desc.attributes[i];
    if (attribute.name == nullptr || *attribute.name == '\0')
      reader.refuse("attribute number " + std::to_string(i) + " has no name");
    for (const NamedView& other : arrays.attributes)
      if (other.name == attribute.name) reader.refuse("two attributes are called '" + other.name + "'");
    arrays.attributes.push_back({attribute.name, reader.view(attribute.values, INSITU_USE_ATTRIBUTE,
                                                             "attribute '" + std::string(attribute.name) + "'")});
  }
  for (std::uint64_t i = 0; i < desc.payload_count; ++i)
    arrays.payload.push_back(reader.view(desc.payload[i], use_payload, "payload number " + std::to_string(i)));
}

// After the attributes.
void read_radius_map(const insitu_particles_desc& desc, const Reader& reader, ParticleArrays& arrays) {
  constexpr std::uint64_t most_entries = 65536;
  if (desc.radius_attribute == nullptr) {
    if (desc.radius_map != nullptr || desc.radius_map_count != 0) reader.refuse("radius_map needs radius_attribute");
    return;
  }
  if (arrays.radius || !arrays.type_radius.empty())
    reader.refuse("radius_attribute is not for sets with a radius array or type_radius");
  const std::string name = desc.radius_attribute;
  const kernels::ArrayView* const values = find_attribute(arrays, name);
  if (values == nullptr) reader.refuse("radius_attribute: there is no attribute '" + name + "'");
  if (desc.radius_component > values->components)
    reader.refuse("radius_component is " + std::to_string(desc.radius_component) + ", '" + name + "' has " +
                  std::to_string(values->components) + " components");
  if (desc.radius_map == nullptr || desc.radius_map_count < 2 || desc.radius_map_count > most_entries)
    reader.refuse("radius_map is NULL, or radius_map_count is not 2 to " + std::to_string(most_entries));
  RadiusMap map{*values, desc.radius_component, {desc.radius_range[0], desc.radius_range[1]}, {}};
  const double density = static_cast<double>(desc.radius_map_count - 1) / (map.range[1] - map.range[0]);
  if (!(map.range[0] < map.range[1] && std::isfinite(density) && density > 0.0))
    reader.refuse("radius_range does not ascend, or is not finite");
  map.radii.assign(desc.radius_map, desc.radius_map + desc.radius_map_count);
  for (const double radius : map.radii)
    if (!(radius >= 0.0 && std::isfinite(radius)))
      reader.refuse("radius_map has an entry that is negative or not finite");
  arrays.radius_map = std::move(map);
}

}  // namespace

ParticleArrays read_particle_arrays(const insitu_particles_desc& desc, const std::string& set_name,
                                    ParticleOrder order) {
  Reader reader(set_name, order);
  if (desc.position == nullptr) reader.refuse("position is NULL");
  ParticleArrays arrays;
  arrays.position = reader.view(desc.position, INSITU_USE_POSITION, "position");
  read_lattice(desc, reader, arrays);
  read_radii(desc, reader, arrays);
  read_attributes(desc, reader, arrays);
  read_radius_map(desc, reader, arrays);
  return arrays;
}

ParticleOrder read_order(std::uint32_t order) {
  if (order > INSITU_ORDER_COPY)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT,
                "order is none of INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE and INSITU_ORDER_COPY");
  return static_cast<ParticleOrder>(order);
}

}  // namespace insitu
