#include "api/glyphs.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"

namespace insitu {
namespace {

ParticlePoints points_of(const Particles& particles, const CellDisplay* cell) {
  ParticlePoints points;
  const ParticleArrays& arrays = particles.arrays();
  points.position = arrays.position;
  points.scale = arrays.position_scale;
  std::copy_n(arrays.position_origin, 3, points.origin);
  if (cell != nullptr) points.cell = cell->cell;
  points.wrap = cell != nullptr && cell->wrap;
  points.prefer = particles.tree().prefer;
  points.prefer_context = particles.tree().prefer_context;
  points.filter = particles.bound_filter();
  return points;
}

// Of the particles in their bounding box, flat directions left out.
double mean_spacing(const Particles& particles) {
  const kernels::PkdTree& tree = particles.tree();
  double spacing = 1.0;
  int dimensions = 0;
  for (int c = 0; c < 3; ++c) dimensions += tree.upper[c] > tree.lower[c] ? 1 : 0;
  if (dimensions == 0) return 2.0 * tree.radius_max * particles.position_scale();
  for (int c = 0; c < 3; ++c)
    if (tree.upper[c] > tree.lower[c]) spacing *= std::pow(tree.upper[c] - tree.lower[c], 1.0 / dimensions);
  return spacing * std::pow(static_cast<double>(tree.count), -1.0 / dimensions) * particles.position_scale();
}

}  // namespace

// ------------------------------------------------------------------------------------------------------------- cell --

void ShownCell::build(Budget& budget, const std::optional<CellDisplay>& display, const Particles& particles) {
  release();
  if (!display) return;
  display_ = display;
  double copies = 1.0;
  for (const std::uint32_t n : display_->replicate) copies *= n;
  if (display_->wrap && particles.shown_count() > 0) {
    for (const auto& image : occupied_images(particles, display_->cell))
      images_.push_back(std::make_unique<ParticleImage>(particles, display_->cell, image));
    copies *= static_cast<double>(images_.size());
  }
  if (copies > 1 << 20)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, particles.name() + ": more than 2^20 copies of the cell");
  if (display_->outline)
    outline_.build(budget, OutlineSource{display_->cell, display_->outline_radius}, 12, "the outline of the cell");
}

void ShownCell::release() {
  display_.reset();
  images_.clear();
  outline_.release();
}

void ShownCell::each_copy(const std::function<void(const glm::dvec3&)>& action) const {
  if (!display_) return action(glm::dvec3(0.0));
  const std::uint32_t* n = display_->replicate;
  for (std::uint32_t k = 0; k < n[2]; ++k)
    for (std::uint32_t j = 0; j < n[1]; ++j)
      for (std::uint32_t i = 0; i < n[0]; ++i) {
        const double count[3] = {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        double offset[3];
        display_->cell.offset_of(count, offset);
        action({offset[0], offset[1], offset[2]});
      }
}

void ShownCell::each_instance(const Particles& particles,
                              const std::function<void(const Geometry&, const glm::dvec3&)>& action) const {
  each_copy([&](const glm::dvec3& shift) {
    if (!display_ || !display_->wrap) return action(particles, shift);
    for (const auto& image : images_) {
      double offset[3];
      display_->cell.offset_of(image->image().data(), offset);
      action(*image, shift - glm::dvec3(offset[0], offset[1], offset[2]));
    }
  });
}

// ----------------------------------------------------------------------------------------------------- bonds, arrows
// --

std::uint64_t Glyphs::borrowed_bytes() const {
  return bonds && bonds->pairs ? bonds->pairs->count * 2 * kernels::size_of(bonds->pairs->type) : 0;
}

// FNV-1a (Fowler, Noll, Vo), over whole indices.
std::uint64_t Glyphs::checksum() const {
  if (!bonds || !bonds->pairs) return 0;
  const kernels::ArrayView& pairs = *bonds->pairs;
  std::uint64_t sum = 0xcbf29ce484222325;
  for (std::uint64_t pair = 0; pair < pairs.count; ++pair) {
    for (std::uint32_t c = 0; c < 2; ++c) {
      std::uint64_t value = 0;
      std::memcpy(&value, pairs.address(pair, c), kernels::size_of(pairs.type));
      sum = (sum ^ value) * 0x100000001b3;
    }
  }
  return sum;
}

void Glyphs::check(const std::string& name, const Particles& particles) const {
  if (bonds && bonds->pairs && particles.order() == ParticleOrder::permute)
    throw Error(INSITU_ERROR_UNSUPPORTED,
                name + ": pairs name places in the arrays of " + particles.name() +
                    ", which INSITU_ORDER_PERMUTE changes; use another order, or bonds by distance");
  if (!vectors) return;
  const kernels::ArrayView* values = particles.attribute(vectors->attribute);
  if (values == nullptr)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, name + ": there is no attribute '" + vectors->attribute +
                                                   "'; there are: " + particles.attribute_names());
  if (values->components != 3)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, name + ": attribute '" + vectors->attribute + "' has " +
                                                   std::to_string(values->components) +
                                                   " components; arrows need three");
}

std::string Glyphs::build(Budget& budget, const Particles& particles, const CellDisplay* cell) {
  built_ = false;
  const ParticlePoints points = points_of(particles, cell);
  std::string text = bonds ? build_bonds(budget, particles, points) : build_arrows(budget, particles, points);
  built_ = true;
  return text;
}

std::string Glyphs::build_bonds(Budget& budget, const Particles& particles, const ParticlePoints& points) {
  constexpr std::uint64_t most = std::uint64_t{1} << 31;
  BondSource source;
  source.points = points;
  source.periodic = (bonds->flags & INSITU_BONDS_PERIODIC) != 0 && points.cell && points.cell->repeats();
  source.ends = (bonds->flags & INSITU_BONDS_FLAT_ENDS) != 0 ? kernels::StickEnds::flat : kernels::StickEnds::round;
  source.radius = bonds->radius > 0.0 ? bonds->radius : 0.25 * particles.tree().radius_max * points.scale;
  if (bonds->by_pairs) {
    source.pairs = *bonds->pairs;
  } else {
    BondSearch search;
    search.cutoff = bonds->cutoff;
    search.by_radius = bonds->cutoff_by_radius;
    search.radius = particles.tree().radius;
    search.radius_max = particles.tree().radius_max;
    search.periodic = source.periodic;
    find_bonds(budget, points, search, found_);
    static constexpr FoundBond none{};
    source.found = found_.empty() ? &none : found_.data();  // not NULL, which means pairs
    source.found_count = found_.size();
  }
  const std::uint64_t pairs = source.pair_count();
  if (pairs >= most) throw Error(INSITU_ERROR_UNSUPPORTED, "bonds: more than 2^31 - 1 pairs");
  bond_sticks_.build(budget, source, 2 * pairs, "the tree over the bonds");
  // Whatever is drawn of a pair has a first half, or is one.
  std::uint64_t bad = pairs;
  for (std::uint64_t i = 0; i < bond_sticks_.drawn_count(); ++i) bad -= bond_sticks_.drawn_ids()[i] % 2 == 0 ? 1 : 0;
  if (points.filter != nullptr)
    for (std::uint64_t pair = 0; pair < pairs; ++pair) bad -= source.is_filtered(pair) ? 1 : 0;
  if (bad == 0) return {};
  return std::to_string(bad) + " of " + std::to_string(pairs) +
         " bonds are not drawn: an index is out of range, both ends are the same, or a position is not finite";
}

std::string Glyphs::build_arrows(Budget& budget, const Particles& particles, const ParticlePoints& points) {
  ArrowSource source;
  source.points = points;
  source.vectors = *particles.attribute(vectors->attribute);
  const std::uint64_t count = points.count();
  if (count >= std::uint64_t{1} << 31) throw Error(INSITU_ERROR_UNSUPPORTED, "vectors: more than 2^31 - 1 particles");
  const double spacing = mean_spacing(particles);
  source.scale = vectors->scale;
  if (source.scale == 0.0) {
    const double longest = value_range(source.vectors, 0).high;
    source.scale = longest > 0.0 && std::isfinite(longest) ? 2.0 * spacing / longest : 1.0;
  }
  source.radius = vectors->radius > 0.0 ? vectors->radius : 0.05 * spacing;
  source.head_radius = vectors->head_radius > 0.0 ? vectors->head_radius : 2.5 * source.radius;
  source.head_length = vectors->head_length > 0.0 ? vectors->head_length : 2.5 * source.head_radius;
  source.centred = (vectors->flags & INSITU_VECTORS_CENTRED) != 0;
  std::uint64_t bad = 0;
  for (std::uint64_t item = 0; item < count; ++item) bad += source.is_good(item) || !points.is_shown(item) ? 0 : 1;
  arrows_.build(budget, source, 2 * count, "the tree over the arrows");
  if (bad == 0) return {};
  return std::to_string(bad) + " of " + std::to_string(count) +
         " arrows are not drawn: the vector or the position is not finite, or above 1e100";
}

void Glyphs::release() {
  built_ = false;
  if (bonds) bonds->pairs.reset();
  bond_sticks_.release();
  arrows_.release();
}

const Geometry& Glyphs::geometry() const {
  if (bonds) return bond_sticks_;
  return arrows_;
}

}  // namespace insitu
