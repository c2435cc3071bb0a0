// Building the tree of kernels/box_tree.h.
#pragma once

#include "core/budget.h"
#include "kernels/box_tree.h"

namespace insitu {

struct ItemBox {
  double lower[3];
  double upper[3];
};

// Owns the nodes, and which item stands at which place.
class BoxTreeStore {
 public:
  // Item ids become index() in the order of the tree. Call within the workers; the result does not depend on threads.
  // Throws Error(over_budget).
  void build(Budget& budget, const std::vector<ItemBox>& boxes, const std::vector<std::uint32_t>& ids,
             const char* what);
  void clear();

  const kernels::BoxTree& tree() const { return tree_; }
  const std::uint32_t* ids() const { return ids_.data(); }
  const ItemBox& bounds() const { return bounds_; }
  std::uint64_t bytes() const { return nodes_.bytes() + ids_.bytes(); }

 private:
  kernels::BoxTree tree_;
  ItemBox bounds_ = {};
  BudgetVector<kernels::BoxNode> nodes_;
  BudgetVector<std::uint32_t> ids_;
};

}  // namespace insitu
