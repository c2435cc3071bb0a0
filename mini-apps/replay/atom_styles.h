// The columns of the "Atoms" section of LAMMPS data files, which depend on the atom style.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace replay {

struct AtomStyle {
  std::string name;
  std::vector<std::string> columns;  // without the three image flags that may follow
  bool image_flags = false;
  bool guessed = false;
};

using TextRow = std::vector<std::string>;

// Columns of a style such as "full" or "hybrid charge sphere"; no columns when the style is not known.
AtomStyle atom_style_named(std::string_view name);
// "angle, atomic, bond, ...": for messages.
std::string atom_style_names();

// The style that fits the first rows of a section without a hint; no columns when none does.
AtomStyle guess_atom_style(const std::vector<TextRow>& rows, std::int64_t type_count);

// Columns that hold whole numbers.
bool is_whole_column(std::string_view name);

}  // namespace replay
