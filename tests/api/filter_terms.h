// Filters as a host writes them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "api_test_tools.h"

namespace insitu::testing {

inline insitu_filter_term filter_term(std::uint32_t kind, const char* attribute = nullptr) {
  insitu_filter_term term;
  insitu_filter_term_init(&term);
  term.kind = kind;
  term.attribute = attribute;
  return term;
}

inline insitu_filter_term range_term(const char* attribute, double low, double high) {
  insitu_filter_term term = filter_term(INSITU_FILTER_RANGE, attribute);
  term.range[0] = low;
  term.range[1] = high;
  return term;
}

inline insitu_filter filter_of(const std::vector<insitu_filter_term>& terms) {
  insitu_filter filter;
  insitu_filter_init(&filter);
  filter.term_count = static_cast<std::uint32_t>(terms.size());
  filter.terms = terms.data();
  return filter;
}

inline insitu_status set_filter(insitu_context context, insitu_geometry set,
                                const std::vector<insitu_filter_term>& terms) {
  const insitu_filter filter = filter_of(terms);
  return insitu_particles_set_filter(context, set, &filter);
}

}  // namespace insitu::testing
