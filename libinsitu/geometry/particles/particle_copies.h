// The arrays behind kernels/selected_copies.h.
#pragma once

#include "core/budget.h"
#include "kernels/pkd_tree.h"

namespace insitu {

class ParticleCopies {
 public:
  // Of `drawn` particles of a tree with so many places. 0: there cannot be copies of so many places.
  static std::uint64_t bytes_for(std::uint64_t places, std::uint64_t drawn);
  // Of tree.selected, which leaves `drawn`. Throws Error(over_budget).
  void build(Budget& budget, const kernels::PkdTree& tree, std::uint64_t drawn);
  void clear();

  const kernels::SelectedCopies& view() const { return view_; }
  std::uint64_t bytes() const { return centres_.bytes() + place_of_.bytes() + before_.bytes(); }

 private:
  BudgetVector<float> centres_;
  BudgetVector<std::uint32_t> place_of_;
  BudgetVector<std::uint32_t> before_;
  kernels::SelectedCopies view_;
};

}  // namespace insitu
