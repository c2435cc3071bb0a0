#include "geometry/particles/particle_copies.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <numeric>

#include "core/float_environment.h"
#include "kernels/pkd_positions.h"

namespace insitu {
namespace {

using kernels::PkdTree;
using kernels::TreeletRun;
using kernels::Treelets;

constexpr const char* what = "copies of what a filter leaves";
constexpr std::uint64_t most_places = std::uint64_t{1} << 32;
constexpr std::uint64_t read_along = 16;  // a vector, on every target

template <class Body>
void for_treelets(const Treelets& treelets, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, treelets.count, 256), [&](const auto& range) {
    const FloatEnvironment guard;
    for (std::uint64_t number = range.begin(); number < range.end(); ++number) body(number);
  });
}

// Calls action(first place, bits) for each 64 places of a treelet, or for what is left of them.
template <class Action>
void for_words(const PkdTree& tree, const Treelets& treelets, std::uint64_t number, const Action& action) {
  const TreeletRun run = treelets.run_of_treelet(number);
  const std::uint64_t end = std::min(run.begin + run.span, tree.count);
  for (std::uint64_t begin = run.begin; begin < end; begin += 64)
    action(begin, tree.selected.bits(begin, std::min<std::uint64_t>(64, end - begin)));
}

template <class Positions>
void copy_in(const PkdTree& tree, const Treelets& treelets, const std::uint32_t* before, float* centres,
             std::uint32_t* place_of) {
  const Positions positions(tree);
  for_treelets(treelets, [&](std::uint64_t number) {
    std::uint64_t at = before[number];
    for_words(tree, treelets, number, [&](std::uint64_t begin, std::uint64_t left) {
      for (; left != 0; left &= left - 1) {
        const std::uint64_t place = begin + static_cast<std::uint64_t>(std::countr_zero(left));
        positions.centre_f32(place, centres + 3 * at);
        place_of[at++] = static_cast<std::uint32_t>(place);
      }
    });
  });
}

}  // namespace

std::uint64_t ParticleCopies::bytes_for(const Treelets& treelets, std::uint64_t drawn) {
  if (treelets.particles > most_places) return 0;
  return 3 * (drawn + read_along) * sizeof(float) + drawn * sizeof(std::uint32_t) +
         (treelets.count + 1) * sizeof(std::uint32_t);
}

void ParticleCopies::build(Budget& budget, const PkdTree& tree, const Treelets& treelets, std::uint64_t drawn) {
  view_ = {};
  centres_.reset(budget, 3 * (drawn + read_along), what);
  place_of_.reset(budget, drawn, what);
  before_.reset(budget, treelets.count + 1, what);
  std::uint32_t* const before = before_.data();
  for_treelets(treelets, [&](std::uint64_t number) {
    std::uint32_t held = 0;
    for_words(tree, treelets, number,
              [&](std::uint64_t, std::uint64_t bits) { held += static_cast<std::uint32_t>(std::popcount(bits)); });
    before[number] = held;
  });
  before[treelets.count] = 0;
  std::exclusive_scan(before, before + treelets.count + 1, before, std::uint32_t{0});
  const auto copy = [&](auto copy_of) { copy_of(tree, treelets, before, centres_.data(), place_of_.data()); };
  switch (layout_of(tree)) {
    case kernels::PkdLayout::placed_f32:
      copy(copy_in<kernels::PlacedPositions<float>>);
      break;
    case kernels::PkdLayout::placed_f64:
      copy(copy_in<kernels::PlacedPositions<double>>);
      break;
    case kernels::PkdLayout::indexed_f32:
      copy(copy_in<kernels::IndexedPositions<float>>);
      break;
    case kernels::PkdLayout::indexed_f64:
      copy(copy_in<kernels::IndexedPositions<double>>);
      break;
    case kernels::PkdLayout::general:
      copy(copy_in<kernels::GeneralPositions>);
      break;
  }
  view_.centres = centres_.data();
  view_.place_of = place_of_.data();
  view_.before = before;
}

void ParticleCopies::clear() {
  view_ = {};
  centres_.clear();
  place_of_.clear();
  before_.clear();
}

}  // namespace insitu
