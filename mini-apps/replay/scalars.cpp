#include "scalars.h"

#include <limits>

namespace replay {
namespace {

template <class To>
void convert(Scalars& scalars) {
  std::vector<To> converted;
  std::visit(
      [&converted](const auto& values) {
        converted.reserve(values.size());
        for (const auto value : values) converted.push_back(static_cast<To>(value));
      },
      scalars);
  scalars = std::move(converted);
}

template <class T>
bool holds(const Scalars& scalars) {
  return std::holds_alternative<std::vector<T>>(scalars);
}

bool is_signed(const Scalars& s) { return holds<std::int32_t>(s) || holds<std::int64_t>(s); }
bool is_unsigned(const Scalars& s) { return holds<std::uint32_t>(s) || holds<std::uint64_t>(s); }

// The smallest type that holds both without loss, except that integers of 64 bit and other kinds meet in a double.
void make_common(Scalars& a, const Scalars& b) {
  if (a.index() == b.index()) return;
  if (is_signed(a) && is_signed(b)) return convert<std::int64_t>(a);
  if (is_unsigned(a) && is_unsigned(b)) return convert<std::uint64_t>(a);
  convert<double>(a);
}

}  // namespace

void pad(Scalars& scalars, std::size_t count) {
  std::visit(
      [count](auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        if (values.size() < count) {
          values.resize(count, std::numeric_limits<T>::has_quiet_NaN ? std::numeric_limits<T>::quiet_NaN() : T{0});
        }
      },
      scalars);
}

void append(Scalars& scalars, const Scalars& more) {
  if (size_of(scalars) == 0) {
    scalars = more;
    return;
  }
  make_common(scalars, more);
  std::visit(
      [&more](auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        std::visit(
            [&values](const auto& added) {
              for (const auto value : added) values.push_back(static_cast<T>(value));
            },
            more);
      },
      scalars);
}

}  // namespace replay
