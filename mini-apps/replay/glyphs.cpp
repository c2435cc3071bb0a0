#include "glyphs.h"

#include <algorithm>
#include <array>

#include "elements.h"

namespace replay {
namespace {

// Two atoms are bonded when they are nearer than this times the sum of their van der Waals radii.
constexpr double bond_share = 0.6;

bool wants_cell(const Options& options) {
  return options.cell || options.wrap || options.replicate != std::array<std::uint32_t, 3>{1, 1, 1};
}

// Are the radii of the step those of the elements?
bool is_vdw(const Frame& frame, const Options& options) {
  return frame.find("element") && (options.radius == "vdw" || (options.radius.empty() && !frame.find("radius")));
}

}  // namespace

double ball_scale(const Options& options) { return options.radius_scale * options.ball_and_stick.value_or(1.0); }

CellChoice choose_cell(const Frame& frame, const Options& options) {
  CellChoice choice;
  insitu_cell_init(&choice.cell);
  if (!wants_cell(options)) return choice;
  if (!frame.box.known) {
    throw UsageError("--cell, --replicate and --wrap need the box of the simulation, which the file does not tell");
  }
  choice.known = true;
  insitu_cell& cell = choice.cell;
  cell.flags = INSITU_CELL_PERIODIC;
  if (options.wrap) cell.flags |= INSITU_CELL_WRAP;
  if (options.cell) cell.flags |= INSITU_CELL_OUTLINE;
  for (std::size_t i = 0; i < 3; ++i) {
    cell.origin[i] = frame.box.origin[i];
    std::copy(frame.box.edge[i].begin(), frame.box.edge[i].end(), cell.vectors[i]);
    cell.replicate[i] = options.replicate[i];
  }
  return choice;
}

BondChoice choose_bonds(const Frame& frame, const Options& options) {
  BondChoice choice;
  insitu_bonds_desc_init(&choice.bonds);
  if (!options.bonds && !options.ball_and_stick) return choice;
  choice.wanted = true;
  if (options.bonds.value_or(0.0) > 0.0) {
    choice.bonds.cutoff = *options.bonds;
  } else {
    if (frame.count() > 0 && !is_vdw(frame, options)) {
      throw UsageError(
          "--bonds auto: needs radii of elements, expected a length, the longest bond (--elements names the elements "
          "of the types)");
    }
    choice.bonds.cutoff_by_radius = bond_share / ball_scale(options);
  }
  choice.bonds.radius = options.stick_radius;
  // Across the borders as soon as the box counts.
  if (wants_cell(options)) choice.bonds.flags |= INSITU_BONDS_PERIODIC;
  return choice;
}

void check_vectors(const Frame& frame, const Options& options) {
  if (options.vectors.empty()) return;
  const Attribute* const attribute = frame.find(options.vectors);
  if (attribute && attribute->components == 3) return;
  std::string names;
  for (const Attribute& other : frame.attributes) {
    if (other.components == 3) names += (names.empty() ? "" : ", ") + other.name;
  }
  throw UsageError("--vectors " + options.vectors + ": expected an attribute with three components, of which " +
                   (names.empty() ? "there are none" : "there are: " + names));
}

}  // namespace replay
