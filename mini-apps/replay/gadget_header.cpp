#include "gadget_header.h"

namespace replay {

std::uint64_t GadgetHeader::all() const { return count_in(*this, all_types); }

std::uint64_t count_in(const GadgetHeader& header, TypeSet types) {
  std::uint64_t sum = 0;
  for (std::size_t t = 0; t < gadget_types; ++t) {
    if ((types >> t & 1u) != 0) sum += header.count[t];
  }
  return sum;
}

std::optional<GadgetLayout> gadget_layout(std::string_view first_bytes) {
  if (first_bytes.size() < sizeof(std::uint32_t)) return std::nullopt;
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(first_bytes[i]));
  };
  const std::uint32_t little = byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
  for (const auto& [marker, tagged] : {std::pair{256u, false}, std::pair{8u, true}}) {
    if (little == marker) return GadgetLayout{std::endian::little, tagged};
    if (little == byte_swapped(marker)) return GadgetLayout{std::endian::big, tagged};
  }
  return std::nullopt;
}

std::optional<std::uint32_t> scalar_bytes(std::uint64_t values, std::uint32_t marker) {
  for (const std::uint32_t bytes : {4u, 8u}) {
    if (static_cast<std::uint32_t>(values * bytes) == marker) return bytes;
  }
  return std::nullopt;
}

}  // namespace replay
