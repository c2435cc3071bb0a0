// From insitu_cell, insitu_bonds_desc and insitu_vectors_desc to checked settings.
#include <algorithm>
#include <cmath>

#include "api/descriptor.h"
#include "api/glyphs.h"
#include "geometry/array_view.h"

namespace insitu {
namespace {

[[noreturn]] void refuse(const std::string& text) { throw Error(INSITU_ERROR_INVALID_ARGUMENT, text); }

double length_of(double value, const std::string& what) {
  if (!(value >= 0.0 && value <= 1e100)) refuse(what + " is negative, not finite, or above 1e100");
  return value;
}

}  // namespace

CellDisplay read_cell(const insitu_cell& description) {
  constexpr std::uint32_t known = INSITU_CELL_PERIODIC | INSITU_CELL_WRAP | INSITU_CELL_OUTLINE;
  if ((description.flags & ~known) != 0) refuse("cell: unknown flags");
  CellDisplay display;
  Cell& cell = display.cell;
  double longest = 0.0;
  double copies = 1.0;
  for (int i = 0; i < 3; ++i) {
    cell.origin[i] = description.origin[i];
    std::copy_n(description.vectors[i], 3, cell.edge[i]);
    cell.periodic[i] = (description.flags >> i & 1) != 0;
    longest = std::max(longest, std::hypot(cell.edge[i][0], cell.edge[i][1], cell.edge[i][2]));
    display.replicate[i] = std::max(1u, description.replicate[i]);
    copies *= display.replicate[i];
  }
  if (copies > 1 << 20) refuse("cell: more than 2^20 copies");
  cell.prepare();
  display.wrap = (description.flags & INSITU_CELL_WRAP) != 0;
  if (display.wrap && !cell.repeats()) refuse("cell: INSITU_CELL_WRAP needs an axis that is periodic");
  display.outline = (description.flags & INSITU_CELL_OUTLINE) != 0;
  display.outline_radius = length_of(description.outline_radius, "cell: outline_radius");
  if (display.outline_radius == 0.0) display.outline_radius = longest / 400.0;
  const double* rgb = description.outline_color;
  for (int c = 0; c < 3; ++c)
    if (!(rgb[c] >= 0.0 && std::isfinite(rgb[c]))) refuse("cell: outline_color is negative or not finite");
  const bool any = rgb[0] != 0.0 || rgb[1] != 0.0 || rgb[2] != 0.0;
  display.outline_color = any ? Rgba{static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])}
                              : Rgba{0.1f, 0.1f, 0.1f};
  return display;
}

BondSettings read_bonds(const insitu_bonds_desc& description, const std::string& name) {
  constexpr std::uint32_t known = INSITU_BONDS_FLAT_ENDS | INSITU_BONDS_OWN_STYLE | INSITU_BONDS_PERIODIC;
  if ((description.flags & ~known) != 0) refuse(name + ": unknown flags of bonds");
  BondSettings settings;
  settings.flags = description.flags;
  settings.cutoff = length_of(description.cutoff, name + ": cutoff");
  settings.cutoff_by_radius = length_of(description.cutoff_by_radius, name + ": cutoff_by_radius");
  settings.radius = length_of(description.radius, name + ": radius");
  settings.by_pairs = description.pairs != nullptr;
  const int ways =
      (settings.by_pairs ? 1 : 0) + (settings.cutoff > 0.0 ? 1 : 0) + (settings.cutoff_by_radius > 0.0 ? 1 : 0);
  if (ways > 1) refuse(name + ": only one of pairs, cutoff and cutoff_by_radius can say which bonds there are");
  if (settings.by_pairs) {
    insitu_array array;
    try {
      array = copy_in(description.pairs, "insitu_array");
    } catch (const Error& error) {
      throw Error(error.status(), name + ": pairs: " + error.what());
    }
    settings.pairs = checked_view(array, INSITU_USE_PAIRS, name + ": pairs");
  }
  return settings;
}

VectorSettings read_vectors(const insitu_vectors_desc& description, const std::string& name) {
  if ((description.flags & ~std::uint32_t{INSITU_VECTORS_CENTRED}) != 0) refuse(name + ": unknown flags of vectors");
  if (description.attribute == nullptr || *description.attribute == '\0') refuse(name + ": attribute has no name");
  VectorSettings settings;
  settings.flags = description.flags;
  settings.attribute = description.attribute;
  settings.scale = length_of(description.scale, name + ": scale");
  settings.radius = length_of(description.radius, name + ": radius");
  settings.head_radius = length_of(description.head_radius, name + ": head_radius");
  settings.head_length = length_of(description.head_length, name + ": head_length");
  return settings;
}

}  // namespace insitu
