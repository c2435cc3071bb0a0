// Which particles of a set are drawn: what insitu_filter says, and what that comes to with the arrays of a step.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "geometry/filter/place_terms.h"
#include "geometry/filter/range_term.h"
#include "geometry/filter/set_term.h"

namespace insitu {

// insitu_filter_term, checked.
struct FilterTerm {
  enum class Kind : std::uint8_t { range, set, box, plane };

  Kind kind = Kind::range;
  bool negated = false;
  std::uint32_t alternative = 0;
  std::string attribute;  // range, set
  std::uint32_t component = 0;
  double range[2] = {};
  MemberSet members;
  double lower[3] = {};
  double upper[3] = {};
  double plane[4] = {};

  bool needs_attribute() const { return kind == Kind::range || kind == Kind::set; }
};

// A disjunctive normal form: the terms of one alternative must all hold, of one alternative.
class Filter {
 public:
  explicit Filter(std::vector<FilterTerm> terms);
  // Those of an alternative stand together.
  const std::vector<FilterTerm>& terms() const { return terms_; }

 private:
  std::vector<FilterTerm> terms_;
};

// A filter with the arrays of a step, which it borrows.
class BoundFilter {
 public:
  // `attribute` finds the arrays of the terms; all of them must be there.
  BoundFilter(std::shared_ptr<const Filter> filter, const WorldPositions& world,
              const std::function<const kernels::ArrayView*(const std::string&)>& attribute);

  // Bit i: the particle at place i of the block is drawn.
  std::uint64_t word(const FilterBlock& block) const;
  // The same for one item.
  bool accepts(std::uint64_t item) const;

 private:
  struct Term {
    std::variant<RangeTerm, SetTerm, BoxTerm, PlaneTerm> test;
    bool negated;
    std::uint32_t alternative;
  };

  std::shared_ptr<const Filter> filter_;  // has the members of sets
  std::vector<Term> terms_;
};

}  // namespace insitu
