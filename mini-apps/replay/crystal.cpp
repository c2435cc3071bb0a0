#include "crystal.h"

#include <gemmi/numb.hpp>
#include <gemmi/symmetry.hpp>
#include <gemmi/unitcell.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "elements.h"
#include "model_frame.h"

namespace replay {
namespace {

using gemmi::cif::as_number;
using gemmi::cif::as_string;

gemmi::UnitCell cell_of(gemmi::cif::Block& block) {
  gemmi::cif::Table table =
      block.find("_cell_", {"length_a", "length_b", "length_c", "angle_alpha", "angle_beta", "angle_gamma"});
  if (!table.ok()) throw std::runtime_error("no unit cell, expected _cell_length_a and so on");
  const auto row = table.one();
  std::array<double, 6> value = {};
  for (int i = 0; i < 6; ++i) {
    value[static_cast<std::size_t>(i)] = as_number(row[i]);
    if (!(value[static_cast<std::size_t>(i)] > 0.0)) throw std::runtime_error("the unit cell is no cell");
  }
  return {value[0], value[1], value[2], value[3], value[4], value[5]};
}

// As the file lists them; by the name of the space group alone, which can leave the origin open, only without a list.
std::vector<gemmi::Op> symmetry_operations(gemmi::cif::Block& block, const gemmi::UnitCell& cell) {
  std::vector<gemmi::Op> operations;
  for (const char* tag : {"_symmetry_equiv_pos_as_xyz", "_space_group_symop_operation_xyz"}) {
    for (const std::string& text : block.find_values(tag)) {
      operations.push_back(gemmi::parse_triplet(as_string(text)));
    }
    if (!operations.empty()) return operations;
  }
  for (const char* tag : {"_symmetry_space_group_name_H-M", "_space_group_name_H-M_alt"}) {
    for (const std::string& text : block.find_values(tag)) {
      const gemmi::SpaceGroup* const group = gemmi::find_spacegroup_by_name(as_string(text), cell.alpha, cell.gamma);
      if (!group) continue;
      for (const gemmi::Op& operation : group->operations()) operations.push_back(operation);
      return operations;
    }
  }
  return operations;
}

gemmi::Fractional inside_cell(std::array<double, 3> at) {
  for (double& x : at) {
    x -= std::floor(x);
    // A rounding error below a face of the cell must not put an atom on the opposite face.
    if (x > 1.0 - 1e-4) x -= 1.0;
  }
  return {at[0], at[1], at[2]};
}

// The images of a site in one cell. Atoms on a symmetry element are images of themselves: what is closer than half a
// bond is one atom.
std::vector<gemmi::Fractional> images_of(const std::array<double, 3>& site, const gemmi::UnitCell& cell,
                                         const std::vector<gemmi::Op>& operations) {
  constexpr double same_atom = 0.4;
  std::vector<gemmi::Fractional> images = {inside_cell(site)};
  for (const gemmi::Op& operation : operations) {
    const gemmi::Fractional image = inside_cell(operation.apply_to_xyz(site));
    const bool known = std::any_of(images.begin(), images.end(), [&](const gemmi::Fractional& other) {
      return cell.distance_sq(image, other) < same_atom * same_atom;
    });
    if (!known) images.push_back(image);
  }
  return images;
}

}  // namespace

Frame crystal_frame(gemmi::cif::Block& block) {
  const gemmi::UnitCell cell = cell_of(block);
  const std::vector<gemmi::Op> operations = symmetry_operations(block, cell);
  Frame frame;
  frame.box = box_from_cell(cell);
  Attribute element{"element", 1, true, {}};
  Attribute site{"site", 1, true, {}};
  Attribute occupancy{"occupancy", 1, false, {}};
  enum { label, fract_x, fract_y, fract_z, symbol, occupied };
  double number = 0.0;
  for (auto row : block.find("_atom_site_", {"label", "fract_x", "fract_y", "fract_z", "?type_symbol", "?occupancy"})) {
    ++number;
    const std::array<double, 3> at = {as_number(row[fract_x]), as_number(row[fract_y]), as_number(row[fract_z])};
    for (const gemmi::Fractional& image : images_of(at, cell, operations)) {
      const gemmi::Position position = cell.orthogonalize(image);
      frame.position.insert(frame.position.end(), {position.x, position.y, position.z});
      element.values().push_back(element_of_symbol(as_string(row[row.has2(symbol) ? symbol : label])));
      site.values().push_back(number);
      occupancy.values().push_back(row.has2(occupied) ? as_number(row[occupied]) : 1.0);
    }
  }
  frame.attributes = {std::move(element), std::move(site), std::move(occupancy)};
  return frame;
}

}  // namespace replay
