// Particles of very different radii, traced apart: treelets over the few large ones, and others over the rest. Among
// each other every box with a large particle is large, and most of what rays look at in it is in vain (the paper's
// section 3.4 leaves mixed radii open). The tree and the order of the particles are the same for both: what is a class
// is a bit per place.
#pragma once

#include <cstddef>

#include "core/budget.h"
#include "geometry/particles/particle_copies.h"
#include "geometry/particles/particle_selection.h"
#include "kernels/ray.h"
#include "kernels/treelets.h"

namespace insitu {

// The radius from which particles count as large; infinity when it is as well to leave all together. Estimated from a
// sample of the radii.
double size_limit(const kernels::PkdTree& tree, const ScanResult& all);

class SizeClasses {
 public:
  // Of what `filter` leaves of a tree, or of all of it when that is null. Call within the workers. False, and nothing
  // is kept, when it does not fit into `most_bytes`. Throws Error(over_budget).
  bool build(Budget& budget, const kernels::PkdTree& tree, const BoundFilter* filter, double limit,
             std::uint64_t most_bytes);
  void clear();
  bool exist() const { return small_.treelets.exist(); }

  // As Geometry has them, in the space of the tree.
  void first_hits(const kernels::Ray* rays, kernels::Hit* hits, std::size_t count) const;
  void any_hits(const kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const;

  std::uint64_t bytes() const { return large_.bytes() + small_.bytes(); }
  std::uint64_t treelet_count() const { return large_.treelets.count + small_.treelets.count; }

 private:
  struct Class {
    kernels::PkdTree tree;
    ParticleSelection selection;
    kernels::Treelets treelets;
    BudgetVector<kernels::TreeletNode> nodes;
    ParticleCopies copies;

    std::uint64_t bytes() const { return selection.bytes() + nodes.bytes() + copies.bytes(); }
    bool add_treelets(Budget& budget, std::uint64_t most_bytes);
    void clear();
  };

  Class large_;
  Class small_;
};

}  // namespace insitu
