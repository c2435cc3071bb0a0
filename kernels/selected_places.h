// Which places of a tree are drawn: a bit each, and above them bits that say which words of the level below have any.
#pragma once

#include <cstdint>

namespace insitu::kernels {

// Views the words; they belong to whoever selected. A word that is not read for its bits stands behind those of each
// level, so that two neighbours can always be read together.
struct SelectedPlaces {
  static constexpr unsigned most_levels = 11;

  const std::uint64_t* level[most_levels] = {};  // bits of places, of words of these, ...; the last is a single word

  // Of runs that have any, a place in 2^thinning is drawn, or more: leaves may be so much longer.
  unsigned thinning = 0;

  static std::uint64_t words(std::uint64_t bits) { return (bits + 63) / 64; }

  // No filter: every place is drawn.
  bool all() const { return level[0] == nullptr; }
  bool has(std::uint64_t place) const { return all() || (level[0][place / 64] >> place % 64 & 1) != 0; }

  // Bit i is place begin + i, of `count` places, 1 to 64. Not for all().
  std::uint64_t bits(std::uint64_t begin, std::uint64_t count) const {
    const std::uint64_t* const word = level[0] + begin / 64;
    const std::uint64_t shift = begin % 64;
    return (word[0] >> shift | (word[1] << 1) << (63 - shift)) & (~std::uint64_t{0} >> (64 - count));
  }

  // Whether a place of [begin, end) is drawn. Not for all().
  bool any(std::uint64_t begin, std::uint64_t end) const {
    for (unsigned l = 0; begin < end; ++l) {
      const std::uint64_t first = begin / 64;
      const std::uint64_t last = (end - 1) / 64;
      const std::uint64_t from = ~std::uint64_t{0} << begin % 64;
      const std::uint64_t to = ~std::uint64_t{0} >> (63 - (end - 1) % 64);
      if (first == last) return (level[l][first] & from & to) != 0;
      if ((level[l][first] & from) != 0 || (level[l][last] & to) != 0) return true;
      // The whole words between are bits of the next level.
      begin = first + 1;
      end = last;
    }
    return false;
  }
};

}  // namespace insitu::kernels
