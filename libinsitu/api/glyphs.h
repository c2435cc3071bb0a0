// What stands on a set of particles besides its balls: the cell, with its copies, and bonds or arrows.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "geometry/particles/particle_image.h"
#include "geometry/sticks/arrows.h"
#include "geometry/sticks/bonds.h"
#include "geometry/sticks/outline.h"
#include "insitu/insitu.h"
#include "scene/scene.h"

namespace insitu {

// insitu_cell, checked.
struct CellDisplay {
  Cell cell;
  std::uint32_t replicate[3] = {1, 1, 1};
  bool wrap = false;
  bool outline = false;
  double outline_radius = 0.0;
  Rgba outline_color;
};

// Throws Error(invalid_argument).
CellDisplay read_cell(const insitu_cell& description);

// A cell in force from commit to commit, and what it makes of the particles.
class ShownCell {
 public:
  // Call within the workers, after the particles are built. Throws Error.
  void build(Budget& budget, const std::optional<CellDisplay>& display, const Particles& particles);
  void release();

  const CellDisplay* display() const { return display_ ? &*display_ : nullptr; }
  // Calls action(geometry, shift) for what shows the particles, one by one.
  void each_instance(const Particles& particles,
                     const std::function<void(const Geometry&, const glm::dvec3&)>& action) const;
  // As often as the cell is drawn: for geometries that already stand within it.
  void each_copy(const std::function<void(const glm::dvec3&)>& action) const;
  const Sticks<OutlineSource>* outline() const { return display_ && display_->outline ? &outline_ : nullptr; }

 private:
  std::optional<CellDisplay> display_;
  std::vector<std::unique_ptr<ParticleImage>> images_;  // with wrap
  Sticks<OutlineSource> outline_;
};

// insitu_bonds_desc, checked.
struct BondSettings {
  std::uint32_t flags = 0;
  double cutoff = 0.0;
  double cutoff_by_radius = 0.0;
  double radius = 0.0;
  std::optional<kernels::ArrayView> pairs;  // borrowed until the end of the step
  bool by_pairs = false;
};

// insitu_vectors_desc, checked.
struct VectorSettings {
  std::uint32_t flags = 0;
  std::string attribute;
  double scale = 0.0;
  double radius = 0.0;
  double head_radius = 0.0;
  double head_length = 0.0;
};

// Throw Error; the text names the object and what is wrong.
BondSettings read_bonds(const insitu_bonds_desc& description, const std::string& name);
VectorSettings read_vectors(const insitu_vectors_desc& description, const std::string& name);

// Bonds or arrows of one set.
class Glyphs {
 public:
  explicit Glyphs(std::uint64_t set) : set_(set) {}

  std::uint64_t set() const { return set_; }  // id of the particles
  std::optional<BondSettings> bonds;
  std::optional<VectorSettings> vectors;

  bool takes_part() const { return vectors || (bonds && (!bonds->by_pairs || bonds->pairs)); }
  std::uint64_t borrowed_bytes() const;
  // Changes when a bit of the borrowed pairs does; 0 without pairs.
  std::uint64_t checksum() const;
  // What can be told before anything is built. Throws Error.
  void check(const std::string& name, const Particles& particles) const;
  // Returns a sentence about what could not be drawn, or nothing. Call within the workers. Throws Error.
  std::string build(Budget& budget, const Particles& particles, const CellDisplay* cell);
  void release();

  bool is_built() const { return built_; }
  const Geometry& geometry() const;

 private:
  std::string build_bonds(Budget& budget, const Particles& particles, const ParticlePoints& points);
  std::string build_arrows(Budget& budget, const Particles& particles, const ParticlePoints& points);

  std::uint64_t set_;
  bool built_ = false;
  Sticks<BondSource> bond_sticks_;
  Sticks<ArrowSource> arrows_;
  BudgetVector<FoundBond> found_;
};

}  // namespace insitu
