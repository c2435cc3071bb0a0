#include "filter_text.h"

#include <cmath>
#include <limits>

#include "input_error.h"
#include "numbers.h"
#include "options.h"

namespace replay {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t most_terms = 1024;

class ConditionReader {
 public:
  explicit ConditionReader(const std::string& whole_text) : whole_text_(whole_text) {}

  FilterCondition read(std::string_view text) const {
    FilterCondition condition;
    if (text.substr(0, 4) == "not ") {
      condition.negated = true;
      text = trimmed(text.substr(4));
    }
    if (text.substr(0, 4) == "box:") {
      condition.kind = FilterCondition::Kind::box;
      condition.numbers = numbers(text.substr(4), 6, "six numbers, the lower and the upper corner");
    } else if (text.substr(0, 6) == "plane:") {
      condition.kind = FilterCondition::Kind::plane;
      condition.numbers = numbers(text.substr(6), 4, "four numbers, A x + B y + C z >= D");
      if (condition.numbers[0] == 0.0 && condition.numbers[1] == 0.0 && condition.numbers[2] == 0.0)
        throw wrong("A, B and C of the plane are all 0");
    } else {
      read_values(text, condition);
    }
    return condition;
  }

 private:
  UsageError wrong(const std::string& why) const {
    return UsageError("--filter " + whole_text_ + ": " + why +
                      ", expected NAME:LOW..HIGH, NAME=N,N,..., box:X0,Y0,Z0,X1,Y1,Z1 or plane:A,B,C,D, each perhaps "
                      "with \"not \" before it, and \" or \" between them");
  }

  static std::vector<std::string_view> split(std::string_view text) {
    std::vector<std::string_view> parts;
    for (std::size_t comma = text.find(','); comma != std::string_view::npos; comma = text.find(',')) {
      parts.push_back(trimmed(text.substr(0, comma)));
      text.remove_prefix(comma + 1);
    }
    parts.push_back(trimmed(text));
    return parts;
  }

  std::vector<double> numbers(std::string_view text, std::size_t count, const std::string& what) const {
    std::vector<double> values;
    for (const std::string_view part : split(text)) {
      double value = 0.0;
      if (!parse_number(part, value) || !std::isfinite(value)) throw wrong(quoted(part) + " is no number");
      values.push_back(value);
    }
    if (values.size() != count) throw wrong("there are not " + what);
    return values;
  }

  void read_values(std::string_view text, FilterCondition& condition) const {
    const std::size_t at = text.find_first_of(":=");
    if (at == std::string_view::npos || trimmed(text.substr(0, at)).empty())
      throw wrong(quoted(text) + " is no condition");
    condition.attribute = trimmed(text.substr(0, at));
    const std::string_view values = text.substr(at + 1);
    if (text[at] == '=') {
      condition.kind = FilterCondition::Kind::set;
      for (const std::string_view part : split(values)) {
        std::int64_t value = 0;
        if (!parse_whole(part, value)) throw wrong(quoted(part) + " is no whole number");
        condition.members.push_back(value);
      }
      return;
    }
    const std::size_t dots = values.find("..");
    if (dots == std::string_view::npos) throw wrong(quoted(values) + " is no range");
    condition.range = {end_of(values.substr(0, dots), -infinity), end_of(values.substr(dots + 2), infinity)};
    if (!(condition.range[0] <= condition.range[1])) throw wrong("nothing is within " + quoted(values));
  }

  double end_of(std::string_view text, double open) const {
    double value = open;
    text = trimmed(text);
    if (!text.empty() && (!parse_number(text, value) || std::isnan(value))) throw wrong(quoted(text) + " is no number");
    return value;
  }

  const std::string& whole_text_;
};

}  // namespace

FilterChoice parse_filter(const std::string& text) {
  constexpr std::string_view between = " or ";
  const ConditionReader reader(text);
  FilterChoice choice;
  std::string_view left = text;
  for (std::size_t at = left.find(between); at != std::string_view::npos; at = left.find(between)) {
    choice.push_back(reader.read(trimmed(left.substr(0, at))));
    left.remove_prefix(at + between.size());
  }
  choice.push_back(reader.read(trimmed(left)));
  return choice;
}

std::vector<std::vector<FilterCondition>> alternatives_of(const std::vector<FilterChoice>& choices) {
  std::size_t ways = 1;
  for (const FilterChoice& choice : choices) {
    ways *= choice.size();
    if (ways * choices.size() > most_terms)
      throw UsageError("--filter: so many \"or\" at once come to more than 1024 conditions");
  }
  std::vector<std::vector<FilterCondition>> alternatives(choices.empty() ? 0 : ways);
  for (std::size_t way = 0; way < alternatives.size(); ++way) {
    std::size_t rest = way;
    for (const FilterChoice& choice : choices) {
      alternatives[way].push_back(choice[rest % choice.size()]);
      rest /= choice.size();
    }
  }
  return alternatives;
}

}  // namespace replay
