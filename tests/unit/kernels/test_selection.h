// Places selected one by one, as a filter would: bits and the levels above them, made the plain way.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/pkd_tree.h"

namespace insitu::testing {

class TestSelection {
 public:
  explicit TestSelection(const std::vector<bool>& is_selected) {
    std::vector<bool> bits = is_selected;
    if (bits.empty()) bits.push_back(false);
    do {
      std::vector<std::uint64_t> words(kernels::SelectedPlaces::words(bits.size()) + 1, 0);
      std::vector<bool> above(words.size() - 1, false);
      for (std::size_t i = 0; i < bits.size(); ++i) {
        if (!bits[i]) continue;
        words[i / 64] |= std::uint64_t{1} << i % 64;
        above[i / 64] = true;
      }
      words.back() = 0x5555555555555555;  // is read along, and must not count
      levels_.push_back(words);
      bits = above;
    } while (bits.size() > 1);
    for (std::size_t l = 0; l < levels_.size(); ++l) places_.level[l] = levels_[l].data();
  }
  TestSelection(const TestSelection&) = delete;
  TestSelection& operator=(const TestSelection&) = delete;

  const kernels::SelectedPlaces& places() const { return places_; }

 private:
  std::vector<std::vector<std::uint64_t>> levels_;
  kernels::SelectedPlaces places_;
};

}  // namespace insitu::testing
