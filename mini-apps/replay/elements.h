// Chemical elements: symbols, masses and radii.
#pragma once

#include <string_view>
#include <vector>

namespace replay {

constexpr int element_count = 118;

// Atomic number of "Na", "NA", "na", "Na1", "Na+", "D" (1); 0 when it is no element.
int element_of_symbol(std::string_view symbol);
// "Na" for 11; "?" for numbers outside of 1 to 118.
const char* element_symbol(int atomic_number);
// The atomic number that a value of an attribute stands for: 0 for all that is none.
int atomic_number_of(double value);
// Van der Waals radius in Angstrom; a middling one for 0 and for elements without a known radius.
double vdw_radius(int atomic_number);

// Atomic numbers for the masses of a simulation's particle types; empty when they do not look like atoms in atomic mass
// units: one of them is no element's mass, or all are as small as the masses of reduced units are.
std::vector<int> elements_of_masses(const std::vector<double>& masses);

}  // namespace replay
