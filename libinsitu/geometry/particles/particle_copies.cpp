#include "geometry/particles/particle_copies.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "core/float_environment.h"
#include "kernels/pkd_positions.h"

namespace insitu {
namespace {

using kernels::PkdTree;
using kernels::SelectedPlaces;

constexpr const char* what = "copies of what a filter leaves";
constexpr std::uint64_t most_places = std::uint64_t{1} << 32;
constexpr std::uint64_t read_along = 16;  // a vector, on every target

template <class Positions>
void copy_in(const PkdTree& tree, const std::uint32_t* before, float* centres, std::uint32_t* place_of) {
  const Positions positions(tree);
  const std::uint64_t words = SelectedPlaces::words(tree.count);
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, words, 256), [&](const auto& range) {
    const FloatEnvironment guard;
    for (std::uint64_t k = range.begin(); k < range.end(); ++k) {
      std::uint64_t at = before[k];
      for (std::uint64_t left = tree.selected.level[0][k]; left != 0; left &= left - 1) {
        const std::uint64_t place = 64 * k + static_cast<std::uint64_t>(std::countr_zero(left));
        positions.centre_f32(place, centres + 3 * at);
        place_of[at++] = static_cast<std::uint32_t>(place);
      }
    }
  });
}

}  // namespace

std::uint64_t ParticleCopies::bytes_for(std::uint64_t places, std::uint64_t drawn) {
  if (places > most_places) return 0;
  return 3 * (drawn + read_along) * sizeof(float) + drawn * sizeof(std::uint32_t) +
         (SelectedPlaces::words(places) + 1) * sizeof(std::uint32_t);
}

void ParticleCopies::build(Budget& budget, const PkdTree& tree, std::uint64_t drawn) {
  const std::uint64_t words = SelectedPlaces::words(tree.count);
  view_ = {};
  centres_.reset(budget, 3 * (drawn + read_along), what);
  place_of_.reset(budget, drawn, what);
  before_.reset(budget, words + 1, what);
  std::uint32_t sum = 0;
  for (std::uint64_t k = 0; k < words; ++k) {
    before_.data()[k] = sum;
    sum += static_cast<std::uint32_t>(std::popcount(tree.selected.level[0][k]));
  }
  before_.data()[words] = sum;
  const auto copy = [&](auto copy_of) { copy_of(tree, before_.data(), centres_.data(), place_of_.data()); };
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
  view_.before = before_.data();
}

void ParticleCopies::clear() {
  view_ = {};
  centres_.clear();
  place_of_.clear();
  before_.clear();
}

}  // namespace insitu
