#include "geometry/particles/size_classes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/pkd/treelet_build.h"
#include "kernels/treelet_traverse.h"

namespace insitu {
namespace {

using kernels::Hit;
using kernels::PkdTree;
using kernels::Ray;

constexpr std::size_t batch = 1024;  // as the scene hands them over

// Boxes of treelets around a point: of so many particles with such a radius, evenly in a volume.
double boxes_around_a_point(double particles, double radius, double volume) {
  const double side = std::cbrt(most_per_treelet * volume / particles);
  const double part = 1.0 + 2.0 * radius / side;
  return part * part * part;
}

}  // namespace

double size_limit(const PkdTree& tree, const ScanResult& all) {
  constexpr double none = std::numeric_limits<double>::infinity();
  if (tree.radius.kind == kernels::RadiusView::Kind::uniform || all.drawn < 2) return none;
  double volume = 1.0;
  for (int c = 0; c < 3; ++c) volume *= all.upper[c] - all.lower[c];
  if (!(volume > 0.0)) return none;

  // How many there are in each half octave below the largest.
  constexpr int steps = 32;
  constexpr std::uint64_t most_samples = 65536;
  double in_step[steps] = {};
  double sampled = 0.0;
  const std::uint64_t stride = std::max<std::uint64_t>(1, tree.position.count / most_samples);
  for (std::uint64_t item = 0; item < tree.position.count; item += stride) {
    const double radius = tree.radius.value(item);
    if (!(radius > 0.0 && radius <= all.radius_max)) continue;
    const double step = 2.0 * std::log2(all.radius_max / radius);
    in_step[static_cast<int>(std::min(step, steps - 1.0))] += 1.0;
    sampled += 1.0;
  }
  if (sampled == 0.0) return none;

  const auto drawn = static_cast<double>(all.drawn);
  // A second set of boxes costs something too, and most particles are to be small.
  constexpr double worth_it = 0.6;
  double least = worth_it * boxes_around_a_point(drawn, all.radius_max, volume);
  double limit = none;
  double large = 0.0;
  for (int step = 0; step + 1 < steps; ++step) {
    large += in_step[step] * drawn / sampled;
    if (large > drawn / 4.0) break;
    const double radius = all.radius_max * std::exp2(-0.5 * (step + 1));
    const double cost = boxes_around_a_point(std::max(large, 1.0), all.radius_max, volume) +
                        boxes_around_a_point(drawn - large, radius, volume);
    if (cost >= least) continue;
    least = cost;
    limit = radius;
  }
  return limit;
}

void SizeClasses::Class::clear() {
  tree = {};
  selection.clear();
  treelets = {};
  nodes.clear();
  copies.clear();
}

bool SizeClasses::Class::add_treelets(Budget& budget, std::uint64_t most_bytes) {
  tree.selected = selection.places();
  tree.radius_max = selection.found().radius_max;
  if (selection.found().radius_min == tree.radius_max) tree.radius = kernels::uniform_radius(tree.radius_max);
  const double longest = selection.run_length_for(most_per_treelet);
  treelets = treelet_shape(tree.count, treelet_depth(tree.count, longest, most_bytes));
  if (!treelets.exist()) return false;
  nodes.reset(budget, treelets.node_count(), "the treelets of the particles");
  build_treelets(tree, treelets, nodes.data());
  treelets.nodes = nodes.data();
  if (tree.selected.thinning == 0) return true;
  const std::uint64_t bytes = ParticleCopies::bytes_for(treelets, selection.found().drawn);
  if (bytes == 0 || nodes.bytes() + bytes > most_bytes) return true;
  copies.build(budget, tree, treelets, selection.found().drawn);
  tree.copies = copies.view();
  return true;
}

bool SizeClasses::build(Budget& budget, const PkdTree& tree, const BoundFilter* filter, double limit,
                        std::uint64_t most_bytes) {
  clear();
  if (limit == std::numeric_limits<double>::infinity()) return false;
  if (2 * ParticleSelection::bytes_for(tree.count) > most_bytes) return false;
  const auto select = [&](Class& one, bool large) {
    one.tree = tree;
    one.tree.continues = !large;
    one.tree.selected = {};
    one.tree.copies = {};
    one.selection.build(budget, one.tree, [&](const FilterBlock& block) {
      const std::uint64_t word =
          word_of(block, [&](std::uint64_t item) { return (tree.radius.value(item) >= limit) == large; });
      return filter != nullptr ? word & filter->word(block) : word;
    });
  };
  select(large_, true);
  select(small_, false);
  const std::uint64_t left = most_bytes - bytes();
  if (large_.selection.found().drawn != 0 && small_.selection.found().drawn != 0 &&
      large_.add_treelets(budget, left / 4) && small_.add_treelets(budget, most_bytes - bytes()))
    return true;
  clear();
  return false;
}

void SizeClasses::clear() {
  large_.clear();
  small_.clear();
}

void SizeClasses::first_hits(const Ray* rays, Hit* hits, std::size_t count) const {
  Hit own[batch];
  for (std::size_t begin = 0; begin < count; begin += batch) {
    const std::size_t n = std::min(batch, count - begin);
    // What has been hit before is a limit only: of hits at its distance it is the one that stays.
    for (std::size_t i = 0; i < n; ++i) own[i] = {hits[begin + i].t, kernels::no_item};
    kernels::treelet_first_hits(large_.tree, large_.treelets, rays + begin, own, n);
    kernels::treelet_first_hits(small_.tree, small_.treelets, rays + begin, own, n);
    for (std::size_t i = 0; i < n; ++i)
      if (own[i].found()) hits[begin + i] = own[i];
  }
}

void SizeClasses::any_hits(const Ray* rays, std::uint8_t* occluded, std::size_t count) const {
  kernels::treelet_any_hits(large_.tree, large_.treelets, rays, occluded, count);
  kernels::treelet_any_hits(small_.tree, small_.treelets, rays, occluded, count);
}

}  // namespace insitu
