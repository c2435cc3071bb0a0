// The columns of GRO files.
#pragma once

#include <cstddef>
#include <string_view>

namespace replay {

// Columns that each number of an atom's line takes: as far as the decimal points are apart. 0 for other lines.
std::size_t gro_number_width(std::string_view line);
bool is_gro_atom(std::string_view line);

}  // namespace replay
