// Which places of a built tree a filter has left: a bit each, and the bounds of these particles.
#pragma once

#include <functional>

#include "core/budget.h"
#include "geometry/filter/filter.h"
#include "geometry/particles/particle_scan.h"
#include "kernels/pkd_tree.h"

namespace insitu {

class ParticleSelection {
 public:
  // Bit i: the particle at place i of the block is to be drawn.
  using Word = std::function<std::uint64_t(const FilterBlock&)>;

  // One pass over all places, with as many threads as the caller's TBB arena has. Throws Error(over_budget).
  void build(Budget& budget, const kernels::PkdTree& tree, const Word& word);
  // At most, of so many places.
  static std::uint64_t bytes_for(std::uint64_t places) { return places / 7 + 128; }
  void clear();

  // All of them before build(), and after clear().
  const kernels::SelectedPlaces& places() const { return places_; }
  const ScanResult& found() const { return found_; }
  std::uint64_t bytes() const { return words_.bytes(); }
  // Of runs of so many places, 4096 at most, those that have any drawn particle have `wanted` on average. After
  // build().
  double run_length_for(double wanted) const;

 private:
  unsigned thinning_of(std::uint64_t count) const;

  BudgetVector<std::uint64_t> words_;  // all levels, one after another
  kernels::SelectedPlaces places_;
  std::uint64_t places_in_tree_ = 0;
  ScanResult found_ = nothing_found();
};

}  // namespace insitu
