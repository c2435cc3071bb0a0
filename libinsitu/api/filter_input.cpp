#include "api/filter_input.h"

#include <cmath>

#include "api/descriptor.h"
#include "geometry/array_view.h"

namespace insitu {
namespace {

constexpr std::uint32_t most_terms = 1024;
constexpr std::uint32_t most_component = 4;

class TermReader {
 public:
  TermReader(Budget& budget, std::uint32_t number) : budget_(budget), name_("filter: term " + std::to_string(number)) {}

  FilterTerm read(const insitu_filter_term& description) {
    if ((description.flags & ~std::uint32_t{INSITU_FILTER_NOT}) != 0) refuse("unknown flags");
    FilterTerm term;
    term.negated = (description.flags & INSITU_FILTER_NOT) != 0;
    term.alternative = description.alternative;
    switch (description.kind) {
      case INSITU_FILTER_RANGE:
        term.kind = FilterTerm::Kind::range;
        read_attribute(description, term);
        copy_numbers(description.range, 2, "range", term.range);
        break;
      case INSITU_FILTER_SET:
        term.kind = FilterTerm::Kind::set;
        read_attribute(description, term);
        read_members(description, term);
        break;
      case INSITU_FILTER_BOX:
        term.kind = FilterTerm::Kind::box;
        copy_numbers(description.lower, 3, "lower", term.lower);
        copy_numbers(description.upper, 3, "upper", term.upper);
        break;
      case INSITU_FILTER_PLANE:
        term.kind = FilterTerm::Kind::plane;
        copy_numbers(description.plane, 4, "plane", term.plane);
        check_normal(description.plane);
        break;
      default:
        refuse("kind is none of INSITU_FILTER_RANGE, INSITU_FILTER_SET, INSITU_FILTER_BOX and INSITU_FILTER_PLANE");
    }
    return term;
  }

 private:
  [[noreturn]] void refuse(const std::string& text) const {
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, name_ + ": " + text);
  }

  void read_attribute(const insitu_filter_term& description, FilterTerm& term) const {
    if (description.attribute == nullptr || *description.attribute == '\0') refuse("attribute has no name");
    if (description.component > most_component) refuse("component is 0 (value or length) or 1 to 4");
    term.attribute = description.attribute;
    term.component = description.component;
  }

  void read_members(const insitu_filter_term& description, FilterTerm& term) const {
    if (description.set == nullptr) refuse("set is NULL");
    insitu_array array;
    try {
      array = copy_in(description.set, "insitu_array");
    } catch (const Error& error) {
      throw Error(error.status(), name_ + ": set: " + error.what());
    }
    term.members = MemberSet(budget_, checked_view(array, INSITU_USE_TYPE, name_ + ": set"));
  }

  void copy_numbers(const double* from, int count, const char* member, double* to) const {
    for (int i = 0; i < count; ++i) {
      if (std::isnan(from[i])) refuse(std::string(member) + " is not a number");
      to[i] = from[i];
    }
  }

  void check_normal(const double* plane) const {
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(plane[c])) refuse("the normal of the plane is not finite");
    if (plane[0] == 0.0 && plane[1] == 0.0 && plane[2] == 0.0) refuse("the normal of the plane has no length");
  }

  Budget& budget_;
  std::string name_;
};

}  // namespace

std::shared_ptr<const Filter> read_filter(Budget& budget, const insitu_filter& description) {
  const std::uint32_t count = description.term_count;
  if (count == 0) return nullptr;
  if (description.terms == nullptr)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, "filter: terms is NULL but term_count is not 0");
  if (count > most_terms) throw Error(INSITU_ERROR_INVALID_ARGUMENT, "filter: more than 1024 terms");
  // The caller's structs may be shorter or longer than ours: they stand as far apart as the first one says.
  const auto* bytes = reinterpret_cast<const unsigned char*>(description.terms);
  std::uint32_t size = 0;
  std::memcpy(&size, bytes, sizeof size);
  std::vector<FilterTerm> terms;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto* theirs = reinterpret_cast<const insitu_filter_term*>(bytes + std::size_t{i} * size);
    terms.push_back(TermReader(budget, i).read(copy_in(theirs, "insitu_filter_term")));
  }
  return std::make_shared<const Filter>(std::move(terms));
}

}  // namespace insitu
