// What a filter does to a set of particles: of the tree it leaves everything but bits and the boxes of treelets alone.
#include "core/error.h"
#include "geometry/particles/particles.h"
#include "geometry/pkd/treelet_build.h"

namespace insitu {

void Particles::check_filter(const Filter& filter) const {
  for (const FilterTerm& term : filter.terms()) {
    if (!term.needs_attribute()) continue;
    const kernels::ArrayView* values = attribute(term.attribute);
    if (values == nullptr)
      throw Error(INSITU_ERROR_INVALID_ARGUMENT, name_ + ": there is no attribute '" + term.attribute +
                                                     "' to filter by; there are: " + attribute_names());
    if (term.component > values->components)
      throw Error(INSITU_ERROR_INVALID_ARGUMENT, name_ + ": attribute '" + term.attribute + "' has " +
                                                     std::to_string(values->components) + " components, not " +
                                                     std::to_string(term.component) + ", to filter by");
  }
}

void Particles::apply_filter(Budget& budget) {
  tree_.selected = {};
  bound_filter_.reset();
  shown_ = all_;
  if (!filter_) return selection_.clear();
  WorldPositions world;
  world.position = arrays_->position;
  world.scale = arrays_->position_scale;
  std::copy_n(arrays_->position_origin, 3, world.origin);
  bound_filter_.emplace(filter_, world, [this](const std::string& name) { return attribute(name); });
  selection_.build(budget, tree_, *bound_filter_);
  tree_.selected = selection_.places();
  shown_ = selection_.found();
}

void Particles::select(Budget& budget) {
  apply_filter(budget);
  if (treelets_.exist()) build_treelets(tree_, treelets_, treelet_nodes_.data());
}

}  // namespace insitu
