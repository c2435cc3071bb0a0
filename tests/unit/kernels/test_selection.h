// Places selected one by one, as a filter would: bits and the levels above them, made the plain way.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/pkd_tree.h"

namespace insitu::testing {

class TestSelection {
 public:
  // With a tree, whose places these are: copies of the centres as well.
  explicit TestSelection(const std::vector<bool>& is_selected, const kernels::PkdTree* tree = nullptr) {
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
    if (tree == nullptr) return;
    for (std::uint64_t place = 0; place < is_selected.size(); ++place) {
      if (place % 64 == 0) before_.push_back(static_cast<std::uint32_t>(place_of_.size()));
      if (!is_selected[place]) continue;
      place_of_.push_back(static_cast<std::uint32_t>(place));
      double centre[3];
      tree->centre(place, centre);
      for (const double x : centre) centres_.push_back(static_cast<float>(x));
    }
    before_.push_back(static_cast<std::uint32_t>(place_of_.size()));
    centres_.resize(centres_.size() + std::size_t{3} * 16);
    copies_ = {centres_.data(), place_of_.data(), before_.data()};
  }
  TestSelection(const TestSelection&) = delete;
  TestSelection& operator=(const TestSelection&) = delete;

  const kernels::SelectedPlaces& places() const { return places_; }
  const kernels::SelectedCopies& copies() const { return copies_; }

 private:
  std::vector<std::vector<std::uint64_t>> levels_;
  kernels::SelectedPlaces places_;
  std::vector<float> centres_;
  std::vector<std::uint32_t> place_of_;
  std::vector<std::uint32_t> before_;
  kernels::SelectedCopies copies_;
};

}  // namespace insitu::testing
