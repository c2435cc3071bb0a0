// Chemical elements where a file gives only the names of atoms and residues.
#pragma once

#include <string_view>

namespace replay {

// Sites without mass, such as the fourth point of some models of water: not drawn.
constexpr int virtual_site = -1;

// "CA" of a protein is carbon, of a residue "CA" it is calcium. 0 for what is no element.
int element_of_atom(std::string_view atom, std::string_view residue);

}  // namespace replay
