// Values of an attribute in the type in which the file holds them, so that nothing is rounded and nothing grows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <variant>
#include <vector>

namespace replay {

using Scalars = std::variant<std::vector<double>, std::vector<float>, std::vector<std::int32_t>,
                             std::vector<std::uint32_t>, std::vector<std::int64_t>, std::vector<std::uint64_t>>;

inline std::size_t size_of(const Scalars& scalars) {
  return std::visit([](const auto& values) { return values.size(); }, scalars);
}

inline double value_at(const Scalars& scalars, std::size_t i) {
  return std::visit([i](const auto& values) { return static_cast<double>(values[i]); }, scalars);
}

// Calls f(index, value as double) for all of them, with the type looked up once.
template <class F>
void for_each_value(const Scalars& scalars, const F& f) {
  std::visit(
      [&f](const auto& values) {
        for (std::size_t i = 0; i < values.size(); ++i) f(i, static_cast<double>(values[i]));
      },
      scalars);
}

// Makes `scalars` `count` long; what is added says that nothing is known: NaN, and 0 where there is none.
void pad(Scalars& scalars, std::size_t count);

// Appends `more`. Where the types differ all become double, or 64 bit where both are integers of the same sign.
void append(Scalars& scalars, const Scalars& more);

}  // namespace replay
