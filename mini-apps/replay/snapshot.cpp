#include "snapshot.h"

#include <array>
#include <filesystem>
#include <utility>

#include "input_error.h"
#include "numbers.h"
#include "snapshot_radii.h"

namespace replay {
namespace {

// Left: names of Gadget's HDF5 files, of SWIFT's where they differ, and tags of Gadget's binary blocks.
constexpr std::array<std::pair<std::string_view, const char*>, 33> names = {{
    {"Velocities", "velocity"},
    {"VEL", "velocity"},
    {"ParticleIDs", "id"},
    {"ID", "id"},
    {"Masses", "mass"},
    {"DynamicalMasses", "mass"},
    {"MASS", "mass"},
    {"InternalEnergy", "internal_energy"},
    {"InternalEnergies", "internal_energy"},
    {"U", "internal_energy"},
    {"Density", "density"},
    {"Densities", "density"},
    {"RHO", "density"},
    {"SmoothingLength", "smoothing_length"},
    {"SmoothingLengths", "smoothing_length"},
    {"HSML", "smoothing_length"},
    {"Potential", "potential"},
    {"Potentials", "potential"},
    {"POT", "potential"},
    {"Acceleration", "acceleration"},
    {"Accelerations", "acceleration"},
    {"ACCE", "acceleration"},
    {"ElectronAbundance", "electron_abundance"},
    {"NE", "electron_abundance"},
    {"NeutralHydrogenAbundance", "neutral_hydrogen_abundance"},
    {"NH", "neutral_hydrogen_abundance"},
    {"StarFormationRate", "star_formation_rate"},
    {"StarFormationRates", "star_formation_rate"},
    {"SFR", "star_formation_rate"},
    {"StellarFormationTime", "formation_time"},
    {"AGE", "formation_time"},
    {"Metallicity", "metallicity"},
    {"Z", "metallicity"},
}};

}  // namespace

std::string attribute_name(std::string_view name_in_file) {
  for (const auto& [name, ours] : names) {
    if (name == name_in_file) return ours;
  }
  return std::string(name_in_file);
}

void SnapshotBuilder::add(const std::string& name, std::uint32_t components, std::size_t first, const Scalars& values) {
  Attribute* attribute = frame_.find(name);
  if (attribute && attribute->components != components) return add(name + "_", components, first, values);
  if (!attribute) {
    attribute = &frame_.add(name, components);
    attribute->scalars = values;  // for its type
    std::visit([](auto& all) { all.clear(); }, attribute->scalars);
  }
  pad(attribute->scalars, first * components);
  append(attribute->scalars, values);
}

void SnapshotBuilder::add_positions(const Scalars& xyz) {
  frame_.position.reserve(frame_.position.size() + size_of(xyz));
  for_each_value(xyz, [this](std::size_t, double x) { frame_.position.push_back(x); });
}

void SnapshotBuilder::add_type(std::int32_t type, std::size_t count) {
  Attribute* attribute = frame_.find("type");
  if (!attribute) {
    attribute = &frame_.add("type", 1, true);
    attribute->scalars = std::vector<std::int32_t>();
  }
  append(attribute->scalars, std::vector<std::int32_t>(count, type));
}

void SnapshotBuilder::finish() {
  for (Attribute& attribute : frame_.attributes) pad(attribute.scalars, frame_.count() * attribute.components);
  derive_attributes(frame_);
  choose_snapshot_radii(frame_);
}

Box cube(double x, double y, double z) {
  if (!(x > 0.0) || !(y > 0.0) || !(z > 0.0)) return {};
  return Box::from_bounds({0, 0, 0}, {x, y, z}, 0, 0, 0);
}

std::optional<PieceName> piece_name(const std::string& path) {
  PieceName name;
  std::string rest = path;
  for (const std::string_view ending : {".gz", ".hdf5", ".h5"}) {
    if (rest.size() > ending.size() && equal_ignoring_case(rest.substr(rest.size() - ending.size()), ending)) {
      name.after = rest.substr(rest.size() - ending.size()) + name.after;
      rest.erase(rest.size() - ending.size());
    }
  }
  const std::size_t dot = rest.rfind('.');
  if (dot == std::string::npos) return std::nullopt;
  std::int64_t number = 0;
  const std::string digits = rest.substr(dot + 1);
  if (digits.find_first_not_of("0123456789") != std::string::npos || !parse_whole(digits, number)) return std::nullopt;
  if (std::to_string(number) != digits) return std::nullopt;
  name.before = rest.substr(0, dot + 1);
  name.number = static_cast<std::uint64_t>(number);
  return name;
}

namespace {
std::string name_of(const std::string& path) { return std::filesystem::path(path).filename().string(); }
}  // namespace

std::vector<std::string> paths_of_pieces(const std::string& path, std::uint64_t pieces) {
  if (pieces <= 1) return {path};
  const auto name = piece_name(path);
  const std::string all = std::to_string(pieces) + " files";
  if (!name) throw InputError(path, 0, "is a part of a snapshot of " + all + ", expected a name such as snap.0");
  if (name->number != 0) {
    throw InputError(path, 0,
                     "is a part of a snapshot of " + all + ", expected the first one, " +
                         replay::quoted(name_of(name->path(0))) + " (the others are found by it)");
  }
  std::vector<std::string> paths;
  for (std::uint64_t i = 0; i < pieces; ++i) {
    paths.push_back(name->path(i));
    if (!std::filesystem::exists(paths.back())) {
      throw InputError(
          path, 0,
          "is a part of a snapshot of " + all + ", of which " + replay::quoted(name_of(paths.back())) + " is missing");
    }
  }
  return paths;
}

}  // namespace replay
