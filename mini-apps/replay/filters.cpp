#include "filters.h"

#include <algorithm>

#include "appearance.h"
#include "filter_text.h"

namespace replay {

FrameFilter::FrameFilter(const Frame& frame, const Options& options) {
  if (frame.count() == 0) return;
  std::uint32_t alternative = 0;
  for (const std::vector<FilterCondition>& together : alternatives_of(options.filters)) {
    for (const FilterCondition& condition : together) {
      const FilterCondition& kept = conditions_.emplace_back(condition);
      insitu_filter_term term;
      insitu_filter_term_init(&term);
      term.flags = kept.negated ? std::uint32_t{INSITU_FILTER_NOT} : 0u;
      term.alternative = alternative;
      switch (kept.kind) {
        case FilterCondition::Kind::range:
          term.kind = INSITU_FILTER_RANGE;
          std::copy(kept.range.begin(), kept.range.end(), term.range);
          break;
        case FilterCondition::Kind::set:
          term.kind = INSITU_FILTER_SET;
          term.set =
              &sets_.emplace_back(insitu_array_records(INSITU_I64, 1, kept.members.data(), kept.members.size(), 0));
          break;
        case FilterCondition::Kind::box:
          term.kind = INSITU_FILTER_BOX;
          std::copy_n(kept.numbers.begin(), 3, term.lower);
          std::copy_n(kept.numbers.begin() + 3, 3, term.upper);
          break;
        case FilterCondition::Kind::plane:
          term.kind = INSITU_FILTER_PLANE;
          std::copy_n(kept.numbers.begin(), 4, term.plane);
          break;
      }
      if (!kept.attribute.empty()) {
        const Attribute* const attribute = find_component(frame, kept.attribute, term.component);
        if (!attribute) {
          throw UsageError("--filter: there is no attribute '" + kept.attribute + "', expected one of " +
                           frame.attribute_names());
        }
        term.attribute = attribute->name.c_str();
      }
      terms_.push_back(term);
    }
    ++alternative;
  }
}

insitu_filter FrameFilter::filter() const {
  insitu_filter filter;
  insitu_filter_init(&filter);
  filter.term_count = static_cast<std::uint32_t>(terms_.size());
  filter.terms = terms_.data();
  return filter;
}

}  // namespace replay
