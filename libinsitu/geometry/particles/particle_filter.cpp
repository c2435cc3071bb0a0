// What a filter does to a set of particles. The tree stays as it is; bits, treelets and copies of few particles do not.
#include "core/error.h"
#include "geometry/particles/particles.h"

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
  tree_.copies = {};
  copies_.clear();
  bound_filter_.reset();
  shown_ = all_;
  if (!filter_) return selection_.clear();
  WorldPositions world;
  world.position = arrays_->position;
  world.scale = arrays_->position_scale;
  std::copy_n(arrays_->position_origin, 3, world.origin);
  bound_filter_.emplace(filter_, world, [this](const std::string& name) { return attribute(name); });
  selection_.build(budget, tree_, [this](const FilterBlock& block) { return bound_filter_->word(block); });
  tree_.selected = selection_.places();
  shown_ = selection_.found();
}

void Particles::add_copies(Budget& budget, std::uint64_t room) {
  if (tree_.selected.thinning == 0) return;
  const std::uint64_t bytes = ParticleCopies::bytes_for(treelets_, shown_.drawn);
  if (bytes == 0 || bytes > room) return;
  copies_.build(budget, tree_, treelets_, shown_.drawn);
  tree_.copies = copies_.view();
}

void Particles::select(Budget& budget) {
  apply_filter(budget);
  add_treelets(budget);
}

}  // namespace insitu
