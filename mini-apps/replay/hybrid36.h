// The numbers of atoms in PDB files, where five columns must do for more than 99999: "A0000" follows, then "A0001", up
// to "ZZZZZ", then the same in small letters (Grosse-Kunstleve, "Hybrid-36").
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace replay {

// Five characters; the numbers that there are end at 87440031.
std::string hybrid36(std::uint64_t number);
std::optional<std::int64_t> parse_hybrid36(std::string_view text);

}  // namespace replay
