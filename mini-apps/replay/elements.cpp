#include "elements.h"

#include <algorithm>
#include <cmath>

#include "element_table.h"
#include "numbers.h"

namespace replay {
namespace {

bool is_element(int atomic_number) { return atomic_number >= 1 && atomic_number <= element_count; }

int element_of_mass(double mass) {
  int best = 0;
  for (int z = 1; z <= element_count; ++z) {
    const double off = std::abs(mass - element_table[z].mass);
    if (best == 0 || off < std::abs(mass - element_table[best].mass)) best = z;
  }
  // Force fields round masses ("1.0", "16.0", "55.85"), which may shift them by more than the neighbours are apart, as
  // with cobalt and nickel; so the tolerance is tight for heavy elements.
  const double tolerance = std::max(0.011, 0.002 * mass);
  return std::abs(mass - element_table[best].mass) <= tolerance ? best : 0;
}

}  // namespace

int element_of_symbol(std::string_view symbol) {
  std::size_t letters = 0;
  while (letters < symbol.size() && starts_with_letter(symbol.substr(letters))) ++letters;
  symbol = symbol.substr(0, letters);
  if (equal_ignoring_case(symbol, "D") || equal_ignoring_case(symbol, "T")) return 1;
  for (int z = 1; z <= element_count; ++z) {
    if (equal_ignoring_case(symbol, element_table[z].symbol)) return z;
  }
  return 0;
}

const char* element_symbol(int atomic_number) {
  return is_element(atomic_number) ? element_table[atomic_number].symbol : "?";
}

int atomic_number_of(double value) { return value >= 1.0 && value < element_count + 1.0 ? static_cast<int>(value) : 0; }

double vdw_radius(int atomic_number) { return element_table[is_element(atomic_number) ? atomic_number : 0].vdw_radius; }

std::vector<int> elements_of_masses(const std::vector<double>& masses) {
  // Masses in reduced units are 1, 2, 0.5, ...: hydrogen and helium alone prove nothing.
  constexpr double too_heavy_for_reduced_units = 5.0;
  if (masses.empty() || *std::max_element(masses.begin(), masses.end()) < too_heavy_for_reduced_units) return {};
  std::vector<int> elements;
  for (const double mass : masses) {
    elements.push_back(element_of_mass(mass));
    if (elements.back() == 0) return {};
  }
  return elements;
}

}  // namespace replay
