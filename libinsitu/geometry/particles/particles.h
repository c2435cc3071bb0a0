// A set of particles: the arrays of this step, the tree over them, and how they look.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/budget.h"
#include "core/workers.h"
#include "geometry/array_view.h"
#include "geometry/filter/filter.h"
#include "geometry/geometry.h"
#include "geometry/particles/particle_copies.h"
#include "geometry/particles/particle_selection.h"
#include "geometry/particles/size_classes.h"
#include "geometry/pkd/pkd_build.h"
#include "geometry/transparent_geometry.h"
#include "kernels/pkd_tree.h"
#include "kernels/ray.h"
#include "kernels/treelets.h"

namespace insitu {

struct NamedView {
  std::string name;
  kernels::ArrayView view;
};

// Radii by the value of an attribute: evenly spaced from range[0] to range[1].
struct RadiusMap {
  kernels::ArrayView values;
  std::uint32_t component = 0;
  double range[2];
  std::vector<double> radii;
};

// Everything that an update brings; checked, and borrowed until release().
struct ParticleArrays {
  kernels::ArrayView position;
  double position_scale = 1.0;  // integers: world = origin + scale * value
  double position_origin[3] = {};
  std::optional<kernels::ArrayView> radius;
  std::optional<kernels::ArrayView> type;
  std::vector<double> type_radius;
  std::optional<RadiusMap> radius_map;
  double radius_default = 0.0;  // 0: half the mean spacing
  double radius_scale = 1.0;
  double treelet_share = 0.0;  // most memory for treelets, as a part of the bytes of the positions; 0: none
  std::vector<NamedView> attributes;
  std::vector<kernels::ArrayView> payload;
};

// "type" is the type array. nullptr when there is none of that name.
const kernels::ArrayView* find_attribute(const ParticleArrays& arrays, const std::string& name);

struct ValueRange {
  double low;
  double high;
  bool empty() const { return !(low <= high); }
};

enum class ParticleOrder : std::uint32_t { index = 0, permute = 1, copy = 2 };  // as INSITU_ORDER_*

class Particles : public TransparentGeometry {
 public:
  Particles(std::string name, ParticleOrder order, bool keep_permutation);
  Particles(const Particles&) = delete;
  Particles& operator=(const Particles&) = delete;

  const std::string& name() const { return name_; }
  ParticleOrder order() const { return order_; }

  void bind(ParticleArrays arrays);
  bool is_bound() const { return arrays_.has_value(); }
  // Builds the tree; with ParticleOrder::permute this is what moves the arrays. Call within `workers`.
  void build(Budget& budget);
  bool is_built() const { return built_; }
  // Throws Error(invalid_argument) when the bound arrays are not those that the filter needs.
  void check_filter(const Filter& filter) const;
  // Which particles are drawn from the next build() or select() on; nullptr: all of them.
  void set_filter(std::shared_ptr<const Filter> filter) { filter_ = std::move(filter); }
  // Makes the selection of the built set anew; the tree stays. Call within the workers. Throws Error(over_budget).
  void select(Budget& budget);
  // Forgets the arrays. What the index occupies is kept for the next step.
  void release();

  std::uint64_t item_count() const { return arrays_ ? arrays_->position.count : 0; }
  // How the tree of this step was made, and how many particles that moved.
  const PkdBuilt& how_built() const { return how_built_; }
  // Particles that can be drawn, and those of them that the filter leaves.
  std::uint64_t drawn_count() const { return built_ ? tree_.count : 0; }
  std::uint64_t shown_count() const { return built_ ? shown_.drawn : 0; }
  bool shows(std::uint64_t item) const { return !bound_filter_ || bound_filter_->accepts(item); }
  const BoundFilter* bound_filter() const { return bound_filter_ ? &*bound_filter_ : nullptr; }
  // In the space of the arrays.
  double shown_radius_max() const { return shown_.radius_max; }
  std::uint64_t borrowed_bytes() const;
  std::uint64_t copied_bytes() const { return copy_.bytes(); }
  std::uint64_t treelet_bytes() const { return treelet_nodes_.bytes() + size_classes_.bytes(); }
  std::uint64_t treelet_count() const { return treelets_.count + size_classes_.treelet_count(); }
  // 0 when there are none.
  double particles_per_treelet() const;
  bool has_size_classes() const { return size_classes_.exist(); }
  std::uint64_t index_bytes() const { return index32_.bytes() + index64_.bytes(); }

  // Of what the filter leaves: world space, radii included; lower > upper when nothing is drawn.
  void bounds(double lower[3], double upper[3]) const override;

  // Rays and hits in world space.
  void first_hits(const kernels::Ray* rays, kernels::Hit* hits, std::size_t count) const override;
  void any_hits(const kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const override;
  Surface surface(std::uint64_t item, const double point[3]) const override;
  void nearest_entries(const kernels::Ray& ray, std::uint32_t number, const kernels::ItemOpacity& opacity,
                       kernels::NearestEntries& entries) const override;
  kernels::OpticalDepth optical_depth(const kernels::Ray& ray, const kernels::ItemOpacity& opacity,
                                      kernels::OpticalDepth depth) const override;
  std::vector<kernels::Span> all_hits(const kernels::Ray& ray) const;
  void centre(std::uint64_t item, double out[3]) const;
  double radius(std::uint64_t item) const;

  // As find_attribute(); attribute_names() lists those that are.
  const kernels::ArrayView* attribute(const std::string& name) const;
  std::string attribute_names() const;

  // insitu_particles_permutation and insitu_particles_restore_order.
  void permutation(std::uint64_t* original, std::uint64_t count) const;
  void restore_order();

  // One sentence for every attribute with non-finite values. Call within the workers.
  std::vector<std::string> describe_bad_values() const;
  // Sums over all records, alike for any order of them: changes when a bit of the borrowed arrays changes.
  std::uint64_t checksum() const;

  // As bound; the tree stands in their space, world = origin + scale * value.
  const ParticleArrays& arrays() const { return *arrays_; }
  double position_scale() const { return arrays_->position_scale; }
  const kernels::PkdTree& tree() const { return tree_; }
  const kernels::Treelets& treelets() const { return treelets_; }

 private:
  // The ray in the space of the arrays: for integer positions, the lattice.
  kernels::Ray local_ray(const kernels::Ray& ray) const;
  template <class Index>
  void build_over_index(Budget& budget, BudgetVector<Index>& index);
  void build_in_place(Budget& budget);
  void build_copy(Budget& budget);
  // Settled before the tree, which has to be as fine as its treelets; their boxes are computed after it.
  void plan_treelets(const Budget& budget);
  void add_treelets(Budget& budget);
  void apply_filter(Budget& budget);
  // Of what a filter leaves, where that is little and fits into `room` bytes.
  void add_copies(Budget& budget, std::uint64_t room);
  std::uint64_t treelet_room(const Budget& budget) const;
  void trace_first_hits(const kernels::Ray* rays, kernels::Hit* hits, std::size_t count) const;
  void trace_any_hits(const kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const;
  template <class Index>
  void list_items(Index* index);
  static bool prefer(const void* self, std::uint64_t a, std::uint64_t b);

  std::string name_;
  ParticleOrder order_;
  bool keep_permutation_;
  bool built_ = false;
  // The index lists every item from 0 to this, in the order of the last step: a good order to start from.
  std::uint64_t listed_items_ = 0;
  PkdBuilt how_built_;
  std::optional<ParticleArrays> arrays_;
  ColumnSet moved_;
  // Bounds of all centres of the tree, and of those that the filter leaves. The box of the tree is a little larger than
  // the former and stays while they fit: with the longest side another one, or a plane moved, hardly a particle would
  // be in place.
  ScanResult all_ = nothing_found();
  ScanResult shown_ = nothing_found();
  kernels::PkdBox<double> root_ = {{1.0, 1.0, 1.0}, {-1.0, -1.0, -1.0}};
  kernels::PkdTree tree_;  // in the space of the arrays: for integer positions, the lattice
  // Place in the tree -> item; with ParticleOrder::permute and on request: place now -> place when the step began.
  BudgetVector<std::uint32_t> index32_;
  BudgetVector<std::uint64_t> index64_;
  kernels::Treelets treelets_;  // none when the tree is traced alone
  BudgetVector<kernels::TreeletNode> treelet_nodes_;
  double size_limit_ = 0.0;       // radius from which particles count as large
  SizeClasses size_classes_;      // instead of treelets_, where radii are very different
  BudgetVector<std::byte> copy_;  // packed positions in tree order
  std::shared_ptr<const Filter> filter_;
  std::optional<BoundFilter> bound_filter_;  // while its selection is in force
  ParticleSelection selection_;
  ParticleCopies copies_;
};

// Smallest and largest finite value; component as in insitu_style. Call within the workers.
ValueRange value_range(const kernels::ArrayView& view, std::uint32_t component);

}  // namespace insitu
