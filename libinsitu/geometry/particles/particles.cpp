#include "geometry/particles/particles.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "geometry/particles/particle_scan.h"
#include "geometry/pkd/treelet_build.h"
#include "kernels/pkd_traverse.h"
#include "kernels/treelet_traverse.h"

namespace insitu {
namespace {

using kernels::ArrayView;
using kernels::PkdTree;
using kernels::RadiusView;

constexpr std::uint64_t most_for_32_bits = std::uint64_t{1} << 32;

bool is_integer(kernels::Scalar type) { return type != kernels::Scalar::f32 && type != kernels::Scalar::f64; }

// Half the edge of the cube that a particle has for itself in the bounding box; flat directions do not count.
double automatic_radius(const ScanResult& scan, double without_extent) {
  double sides[3];
  int dimensions = 0;
  for (int c = 0; c < 3; ++c) {
    const double side = scan.upper[c] - scan.lower[c];
    if (!(side > 0.0)) continue;
    sides[dimensions++] = side;
  }
  if (scan.drawn == 0 || dimensions == 0) return without_extent;
  // Root by root: products of sides may be too small or large for a double.
  const double root = 1.0 / dimensions;
  double radius = 0.5 * std::pow(static_cast<double>(scan.drawn), -root);
  for (int i = 0; i < dimensions; ++i) radius *= std::pow(sides[i], root);
  return radius;
}

constexpr double root_margin = 1.0 / 128;  // of each side, at both of its ends
constexpr double most_root_excess = 3.0 * root_margin;

kernels::PkdBox<double> root_around(const ScanResult& scan) {
  kernels::PkdBox<double> root;
  for (int c = 0; c < 3; ++c) {
    // None where there is no extent: a box without any tells that all particles coincide.
    const double margin = scan.drawn == 0 ? 0.0 : root_margin * (scan.upper[c] - scan.lower[c]);
    root.lower[c] = scan.lower[c] - margin;
    root.upper[c] = scan.upper[c] + margin;
  }
  return root;
}

bool is_good_root(const kernels::PkdBox<double>& root, const ScanResult& scan) {
  for (int c = 0; c < 3; ++c) {
    const double side = scan.upper[c] - scan.lower[c];
    if (!(root.lower[c] <= scan.lower[c] && root.upper[c] >= scan.upper[c])) return false;
    if (!(root.upper[c] - root.lower[c] <= (1.0 + most_root_excess) * side)) return false;
  }
  return true;
}

RadiusView radius_view(const ParticleArrays& arrays) {
  RadiusView view;
  // The tree stands in the space of the arrays, which integer positions scale.
  view.scale = arrays.radius_scale / arrays.position_scale;
  if (arrays.radius) {
    view.kind = RadiusView::Kind::per_item;
    view.array = *arrays.radius;
  } else if (arrays.type && !arrays.type_radius.empty()) {
    view.kind = RadiusView::Kind::by_type;
    view.array = *arrays.type;
    view.table = arrays.type_radius.data();
    view.table_size = arrays.type_radius.size();
  } else if (arrays.radius_map) {
    const RadiusMap& map = *arrays.radius_map;
    view.kind = RadiusView::Kind::by_value;
    view.array = map.values;
    view.component = map.component;
    view.table = map.radii.data();
    view.table_size = map.radii.size();
    view.table_begin = map.range[0];
    view.table_density = static_cast<double>(map.radii.size() - 1) / (map.range[1] - map.range[0]);
  } else {
    view.uniform = arrays.radius_default * view.scale;
  }
  return view;
}

}  // namespace

Particles::Particles(std::string name, ParticleOrder order, bool keep_permutation)
    : name_(std::move(name)), order_(order), keep_permutation_(keep_permutation) {}

void Particles::bind(ParticleArrays arrays) {
  ColumnSet moved;
  if (order_ == ParticleOrder::permute) {
    moved.add(arrays.position, "position");
    if (arrays.radius) moved.add(*arrays.radius, "radius");
    if (arrays.type) moved.add(*arrays.type, "type");
    for (const NamedView& attribute : arrays.attributes) moved.add(attribute.view, "attribute " + attribute.name);
    for (const ArrayView& payload : arrays.payload) moved.add(payload, "payload");
  }
  release();
  moved_ = std::move(moved);
  arrays_ = std::move(arrays);
}

void Particles::release() {
  built_ = false;
  how_built_ = {};
  arrays_.reset();
  moved_.clear();
  tree_ = {};
  treelets_ = {};
  size_classes_.clear();
  bound_filter_.reset();
}

void Particles::build(Budget& budget) {
  const ParticleArrays& arrays = *arrays_;
  tree_ = {};
  tree_.position = arrays.position;
  tree_.radius = radius_view(arrays);
  tree_.prefer = &Particles::prefer;
  tree_.prefer_context = this;

  const bool automatic = tree_.radius.kind == RadiusView::Kind::uniform && tree_.radius.uniform == 0.0;
  ScanResult scan = scan_particles(tree_, !automatic);
  if (automatic) {
    tree_.radius.uniform = automatic_radius(scan, 1.0 / arrays.position_scale) * arrays.radius_scale;
    scan.radius_min = scan.radius_max = tree_.radius.uniform;
  }
  all_ = scan;
  size_limit_ = arrays.treelet_share > 0.0 ? size_limit(tree_, all_) : std::numeric_limits<double>::infinity();
  if (!is_good_root(root_, scan)) root_ = root_around(scan);
  std::copy_n(root_.lower, 3, tree_.lower);
  std::copy_n(root_.upper, 3, tree_.upper);
  tree_.radius_max = scan.radius_max;
  tree_.count = scan.drawn;
  plan_treelets(budget);
  switch (order_) {
    case ParticleOrder::index:
      tree_.position_by_place = false;
      if (tree_.position.count <= most_for_32_bits) {
        index64_.clear();
        build_over_index(budget, index32_);
      } else {
        index32_.clear();
        build_over_index(budget, index64_);
      }
      break;
    case ParticleOrder::permute:
      build_in_place(budget);
      break;
    case ParticleOrder::copy:
      build_copy(budget);
      break;
  }
  // An array, or a table, in which all are the same is as fast as one radius for all.
  if (scan.radius_min == scan.radius_max && scan.drawn == arrays.position.count)
    tree_.radius = kernels::uniform_radius(scan.radius_max);
  apply_filter(budget);
  add_treelets(budget);
  built_ = true;
}

void Particles::plan_treelets(const Budget& budget) {
  treelet_nodes_.clear();  // the index and the copy come first
  size_classes_.clear();
  treelets_ = treelet_shape(tree_.count, treelet_depth(tree_.count, most_per_treelet, treelet_room(budget)));
  if (!treelets_.exist()) return;
  while (tree_.built_leaf > 1 && tree_.built_leaf > tree_.count / treelets_.count) tree_.built_leaf /= 2;
}

std::uint64_t Particles::treelet_room(const Budget& budget) const {
  const double position_bytes =
      static_cast<double>(tree_.count) * static_cast<double>(3 * kernels::size_of(tree_.position.type));
  const double share = std::min(arrays_->treelet_share * position_bytes, 9e18);
  const std::uint64_t held = treelet_bytes();
  const std::uint64_t left = budget.left() > ~std::uint64_t{0} - held ? ~std::uint64_t{0} : budget.left() + held;
  return std::min(static_cast<std::uint64_t>(share), left);
}

void Particles::add_treelets(Budget& budget) {
  // Longer ones where the tree itself has taken the room meanwhile, and where a filter leaves few particles of a run.
  const std::uint64_t room = treelet_room(budget);
  treelets_ = {};
  if (size_classes_.build(budget, tree_, bound_filter(), size_limit_, room)) return treelet_nodes_.clear();
  const double most = tree_.selected.all() ? most_per_treelet : selection_.run_length_for(most_per_treelet);
  treelets_ = treelet_shape(tree_.count, treelet_depth(tree_.count, most, room));
  if (!treelets_.exist()) return treelet_nodes_.clear();
  treelet_nodes_.reset(budget, treelets_.node_count(), "the treelets of the particles");
  build_treelets(tree_, treelets_, treelet_nodes_.data());
  treelets_.nodes = treelet_nodes_.data();
  add_copies(budget, room - treelet_nodes_.bytes());
}

double Particles::particles_per_treelet() const {
  return treelets_.exist() ? static_cast<double>(tree_.count) / static_cast<double>(treelets_.count) : 0.0;
}

namespace {

// The drawable items of [0, count), in their order.
template <class Index>
void list_drawable(const PkdTree& tree, Index* index) {
  const std::uint64_t count = tree.position.count;
  if (tree.count == count) {
    tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, count, 1 << 16), [index](const auto& range) {
      for (std::uint64_t i = range.begin(); i < range.end(); ++i) index[i] = static_cast<Index>(i);
    });
    return;
  }
  std::uint64_t next = 0;
  for (std::uint64_t item = 0; item < count; ++item)
    if (is_drawable(tree, item)) index[next++] = static_cast<Index>(item);
}

}  // namespace

// As the last step left them, when that was nearly the order of this step's tree; otherwise in the order of the arrays.
template <class Index>
void Particles::list_items(Index* index) {
  const std::uint64_t listed = std::exchange(listed_items_, 0);  // until the build has succeeded
  if (listed == tree_.count && tree_.count == tree_.position.count) {
    PkdTree last = tree_;
    last.position_by_place = false;
    if constexpr (sizeof(Index) == 4) last.index32 = index;
    if constexpr (sizeof(Index) == 8) last.index64 = index;
    if (is_nearly_ordered(last)) return;
  }
  list_drawable(tree_, index);
}

template <class Index>
void Particles::build_over_index(Budget& budget, BudgetVector<Index>& index) {
  if (index.size() != tree_.count) listed_items_ = 0;
  index.reset(budget, tree_.count, "the index of the particles");
  list_items(index.data());
  if constexpr (sizeof(Index) == 4) tree_.index32 = index.data();
  if constexpr (sizeof(Index) == 8) tree_.index64 = index.data();
  how_built_ = build_index(tree_, index.data());
  listed_items_ = tree_.count == tree_.position.count ? tree_.count : 0;
}

void Particles::build_in_place(Budget& budget) {
  const std::uint64_t count = tree_.position.count;
  std::vector<MovedColumn> columns = moved_.columns();
  if (keep_permutation_) {
    // Who came from where is one more column that moves along.
    const auto keep = [&](auto& index) {
      using Index = std::remove_pointer_t<decltype(index.data())>;
      index.reset(budget, count, "the kept permutation");
      for (std::uint64_t i = 0; i < count; ++i) index.data()[i] = static_cast<Index>(i);
      columns.push_back({reinterpret_cast<std::byte*>(index.data()), sizeof(Index), sizeof(Index), false});
    };
    if (count <= most_for_32_bits) {
      index64_.clear();
      keep(index32_);
    } else {
      index32_.clear();
      keep(index64_);
    }
  }
  if (tree_.count < count) {
    ColumnsStore<kernels::GeneralPositions> store(tree_, columns);
    std::uint64_t end = count;
    for (std::uint64_t place = 0; place < end;) {
      if (is_drawable(tree_, place)) {
        ++place;
      } else {
        store.swap(place, --end);
      }
    }
  }
  how_built_ = build_columns(tree_, columns);
}

void Particles::build_copy(Budget& budget) {
  if (tree_.position.count > most_for_32_bits)
    throw Error(INSITU_ERROR_UNSUPPORTED,
                name_ + ": INSITU_ORDER_COPY holds at most 2^32 particles; use another order");
  const std::size_t size = kernels::size_of(tree_.position.type);
  index64_.clear();
  if (index32_.size() != tree_.count) listed_items_ = 0;
  index32_.reset(budget, tree_.count, "the index of the particles");
  copy_.reset(budget, tree_.count * 3 * size, "the copy of the positions");
  list_items(index32_.data());
  const ArrayView source = tree_.position;
  std::byte* copy = copy_.data();
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, tree_.count, 1 << 14), [&](const auto& range) {
    for (std::uint64_t i = range.begin(); i < range.end(); ++i)
      for (std::uint32_t c = 0; c < 3; ++c)
        std::memcpy(copy + (3 * i + c) * size, source.address(index32_.data()[i], c), size);
  });
  ArrayView& position = tree_.position;
  position.rows = false;
  position.count = tree_.count;
  position.stride = static_cast<std::ptrdiff_t>(3 * size);
  for (std::uint32_t c = 0; c < 3; ++c) position.base[c] = copy + c * size;
  tree_.index32 = index32_.data();
  const std::uint64_t items = source.count;
  how_built_ = build_columns(
      tree_, {{copy, position.stride, 3 * size, false},
              {reinterpret_cast<std::byte*>(index32_.data()), sizeof(std::uint32_t), sizeof(std::uint32_t), false}});
  listed_items_ = tree_.count == items ? items : 0;
}

// Equal distance means, but for chance, equal centres. Then radius and attributes decide, so that the picture is the
// same for any order of the particles; only twins in everything are left to their places.
bool Particles::prefer(const void* self, std::uint64_t a, std::uint64_t b) {
  const ParticleArrays& arrays = *static_cast<const Particles*>(self)->arrays_;
  const PkdTree& tree = static_cast<const Particles*>(self)->tree_;
  for (std::uint32_t c = 0; c < 3; ++c) {
    const double x = arrays.position.value(a, c);
    const double y = arrays.position.value(b, c);
    if (x != y) return x < y;
  }
  const double radius_a = tree.radius.value(a);
  const double radius_b = tree.radius.value(b);
  if (radius_a != radius_b) return radius_a > radius_b;
  const auto less = [a, b](const ArrayView& view, bool& decided) {
    for (std::uint32_t c = 0; c < view.components; ++c) {
      const double x = view.value(a, c);
      const double y = view.value(b, c);
      decided = x < y || y < x;
      if (decided) return x < y;
      decided = std::isnan(x) != std::isnan(y);
      if (decided) return std::isnan(y);
    }
    return false;
  };
  bool decided = false;
  if (arrays.type) {
    const bool first = less(*arrays.type, decided);
    if (decided) return first;
  }
  for (const NamedView& attribute : arrays.attributes) {
    const bool first = less(attribute.view, decided);
    if (decided) return first;
  }
  return a < b;
}

std::uint64_t Particles::borrowed_bytes() const {
  if (!arrays_) return 0;
  const auto bytes = [](const ArrayView& view) { return view.count * view.components * kernels::size_of(view.type); };
  std::uint64_t sum = bytes(arrays_->position);
  if (arrays_->radius) sum += bytes(*arrays_->radius);
  if (arrays_->type) sum += bytes(*arrays_->type);
  for (const NamedView& attribute : arrays_->attributes) sum += bytes(attribute.view);
  for (const ArrayView& payload : arrays_->payload) sum += bytes(payload);
  return sum;
}

void Particles::bounds(double lower[3], double upper[3]) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (int c = 0; c < 3; ++c) {
    lower[c] = infinity;
    upper[c] = -infinity;
    if (shown_count() == 0) continue;
    const double scale = arrays_->position_scale;
    lower[c] = arrays_->position_origin[c] + (shown_.lower[c] - shown_.radius_max) * scale;
    upper[c] = arrays_->position_origin[c] + (shown_.upper[c] + shown_.radius_max) * scale;
  }
}

namespace {

// Rays are taken into the space of integer positions in batches of this many.
constexpr std::size_t batch = 256;

}  // namespace

void Particles::trace_first_hits(const kernels::Ray* rays, kernels::Hit* hits, std::size_t count) const {
  if (size_classes_.exist()) return size_classes_.first_hits(rays, hits, count);
  if (treelets_.exist()) return kernels::treelet_first_hits(tree_, treelets_, rays, hits, count);
  kernels::pkd_first_hits(tree_, rays, hits, count);
}

void Particles::trace_any_hits(const kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const {
  if (size_classes_.exist()) return size_classes_.any_hits(rays, occluded, count);
  if (treelets_.exist()) return kernels::treelet_any_hits(tree_, treelets_, rays, occluded, count);
  kernels::pkd_any_hits(tree_, rays, occluded, count);
}

void Particles::first_hits(const kernels::Ray* rays, kernels::Hit* hits, std::size_t count) const {
  if (!is_integer(arrays_->position.type)) return trace_first_hits(rays, hits, count);
  const double scale = arrays_->position_scale;
  kernels::Ray local[batch];
  kernels::Hit local_hits[batch];
  for (std::size_t begin = 0; begin < count; begin += batch) {
    const std::size_t n = std::min(batch, count - begin);
    for (std::size_t i = 0; i < n; ++i) {
      local[i] = local_ray(rays[begin + i]);
      local[i].t_max = std::min(local[i].t_max, hits[begin + i].t / scale);
      local_hits[i] = {};
    }
    trace_first_hits(local, local_hits, n);
    for (std::size_t i = 0; i < n; ++i)
      if (local_hits[i].found() && local_hits[i].t * scale < hits[begin + i].t)
        hits[begin + i] = {local_hits[i].t * scale, local_hits[i].item};
  }
}

void Particles::any_hits(const kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const {
  if (!is_integer(arrays_->position.type)) return trace_any_hits(rays, occluded, count);
  kernels::Ray local[batch];
  for (std::size_t begin = 0; begin < count; begin += batch) {
    const std::size_t n = std::min(batch, count - begin);
    for (std::size_t i = 0; i < n; ++i) local[i] = local_ray(rays[begin + i]);
    trace_any_hits(local, occluded + begin, n);
  }
}

std::vector<kernels::Span> Particles::all_hits(const kernels::Ray& ray) const {
  std::vector<kernels::Span> spans;
  const double scale = arrays_->position_scale;
  kernels::pkd_all_hits(tree_, local_ray(ray), spans);
  for (kernels::Span& span : spans) {
    span.t_enter *= scale;
    span.t_leave *= scale;
  }
  std::sort(spans.begin(), spans.end(), [](const kernels::Span& a, const kernels::Span& b) {
    return a.t_enter != b.t_enter ? a.t_enter < b.t_enter : a.item < b.item;
  });
  return spans;
}

void Particles::centre(std::uint64_t item, double out[3]) const {
  const ArrayView& position = arrays_->position;
  for (std::uint32_t c = 0; c < 3; ++c)
    out[c] = arrays_->position_origin[c] + position.value(item, c) * arrays_->position_scale;
}

Surface Particles::surface(std::uint64_t item, const double point[3]) const {
  double at[3];
  centre(item, at);
  const double r = radius(item);
  Surface surface{{}, r, item, item};
  double squares = 0.0;
  for (int c = 0; c < 3; ++c) {
    surface.normal[c] = (point[c] - at[c]) / r;
    squares += surface.normal[c] * surface.normal[c];
    surface.magnitude = std::max(surface.magnitude, std::abs(at[c]));
  }
  const double length = std::sqrt(squares);
  for (double& n : surface.normal) n = length > 0.0 ? n / length : 0.0;
  return surface;
}

double Particles::radius(std::uint64_t item) const { return tree_.radius.value(item) * arrays_->position_scale; }

const ArrayView* find_attribute(const ParticleArrays& arrays, const std::string& name) {
  for (const NamedView& attribute : arrays.attributes)
    if (attribute.name == name) return &attribute.view;
  return name == "type" && arrays.type ? &*arrays.type : nullptr;
}

const ArrayView* Particles::attribute(const std::string& name) const {
  return arrays_ ? find_attribute(*arrays_, name) : nullptr;
}

std::string Particles::attribute_names() const {
  std::string names;
  const auto append = [&names](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
  if (arrays_) {
    for (const NamedView& attribute : arrays_->attributes) append(attribute.name);
    if (arrays_->type) append("type");
  }
  return names.empty() ? "none" : names;
}

}  // namespace insitu
