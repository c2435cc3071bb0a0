#include "atom_names.h"

#include <array>
#include <string>
#include <utility>

#include "elements.h"
#include "numbers.h"

namespace replay {
namespace {

// Names of ions in the force fields of CHARMM and OPLS that are no symbols.
constexpr std::array<std::pair<std::string_view, const char*>, 6> ions = {
    {{"SOD", "Na"}, {"CLA", "Cl"}, {"POT", "K"}, {"CAL", "Ca"}, {"CES", "Cs"}, {"LIT", "Li"}}};

// Two letters that mean this element also inside of larger residues; "CA" and "CD", "HG" and "NE" do not.
constexpr std::array<std::string_view, 12> clear_symbols = {"CL", "BR", "FE", "ZN", "MG", "CU",
                                                            "NI", "SE", "SI", "LI", "AL", "MN"};

// "HB" of "1HB2".
std::string_view letters_of(std::string_view name) {
  while (!name.empty() && !starts_with_letter(name)) name.remove_prefix(1);
  std::size_t letters = 0;
  while (letters < name.size() && starts_with_letter(name.substr(letters))) ++letters;
  return name.substr(0, letters);
}

}  // namespace

int element_of_atom(std::string_view atom, std::string_view residue) {
  const std::string_view letters = letters_of(atom);
  if (letters.empty()) return 0;
  for (const auto& [name, symbol] : ions) {
    if (equal_ignoring_case(letters, name)) return element_of_symbol(symbol);
  }
  // A residue of one atom bears its name.
  if (equal_ignoring_case(letters, letters_of(residue))) {
    if (const int element = element_of_symbol(letters)) return element;
  }
  // The fourth point of water and lone pairs, and where GROMACS hangs the mass of methyl and amine groups.
  for (const std::string_view site : {"MW", "LP", "EP", "MCH", "MNH"}) {
    if (equal_ignoring_case(letters.substr(0, site.size()), site)) return virtual_site;
  }
  for (const std::string_view symbol : clear_symbols) {
    if (equal_ignoring_case(letters, symbol)) return element_of_symbol(symbol);
  }
  return element_of_symbol(letters.substr(0, 1));
}

}  // namespace replay
