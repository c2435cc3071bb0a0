#include "geometry/filter/filter.h"

#include <algorithm>

namespace insitu {

Filter::Filter(std::vector<FilterTerm> terms) : terms_(std::move(terms)) {
  std::stable_sort(terms_.begin(), terms_.end(),
                   [](const FilterTerm& a, const FilterTerm& b) { return a.alternative < b.alternative; });
}

BoundFilter::BoundFilter(std::shared_ptr<const Filter> filter, const WorldPositions& world,
                         const std::function<const kernels::ArrayView*(const std::string&)>& attribute)
    : filter_(std::move(filter)) {
  for (const FilterTerm& term : filter_->terms()) {
    const auto add = [&](auto test) { terms_.push_back({std::move(test), term.negated, term.alternative}); };
    switch (term.kind) {
      case FilterTerm::Kind::range:
        add(RangeTerm{*attribute(term.attribute), term.component, term.range[0], term.range[1]});
        break;
      case FilterTerm::Kind::set:
        add(SetTerm{*attribute(term.attribute), term.component, &term.members});
        break;
      case FilterTerm::Kind::box: {
        BoxTerm box{world, {}, {}};
        std::copy_n(term.lower, 3, box.lower);
        std::copy_n(term.upper, 3, box.upper);
        add(box);
        break;
      }
      case FilterTerm::Kind::plane: {
        PlaneTerm plane{world, {}};
        std::copy_n(term.plane, 4, plane.plane);
        add(plane);
        break;
      }
    }
  }
}

std::uint64_t BoundFilter::word(const FilterBlock& block) const {
  const std::uint64_t all = ~std::uint64_t{0} >> (FilterBlock::most - block.count);
  std::uint64_t accepted = 0;
  for (auto term = terms_.begin(); term != terms_.end();) {
    // Those that no alternative before this one has accepted; terms that cannot matter any more are passed over.
    const std::uint32_t alternative = term->alternative;
    std::uint64_t left = all & ~accepted;
    for (; term != terms_.end() && term->alternative == alternative; ++term) {
      if (left == 0) continue;
      const std::uint64_t holds = std::visit([&](const auto& test) { return test.word(block); }, term->test);
      left &= term->negated ? ~holds : holds;
    }
    accepted |= left;
  }
  return accepted;
}

bool BoundFilter::accepts(std::uint64_t item) const {
  for (auto term = terms_.begin(); term != terms_.end();) {
    const std::uint32_t alternative = term->alternative;
    bool all_hold = true;
    for (; term != terms_.end() && term->alternative == alternative; ++term)
      all_hold =
          all_hold && std::visit([&](const auto& test) { return test.accepts(item); }, term->test) != term->negated;
    if (all_hold) return true;
  }
  return false;
}

}  // namespace insitu
