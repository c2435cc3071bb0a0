// The arrays behind kernels/selected_copies.h.
#pragma once

#include "core/budget.h"
#include "kernels/pkd_tree.h"
#include "kernels/treelets.h"

namespace insitu {

class ParticleCopies {
 public:
  // Of `drawn` particles of a tree, in the treelets that it has. 0: there cannot be copies of so many places.
  static std::uint64_t bytes_for(const kernels::Treelets& treelets, std::uint64_t drawn);
  // Of tree.selected, which leaves `drawn`. With as many threads as the caller's TBB arena has. Throws
  // Error(over_budget).
  void build(Budget& budget, const kernels::PkdTree& tree, const kernels::Treelets& treelets, std::uint64_t drawn);
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
