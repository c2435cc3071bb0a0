#include "geometry/particles/particle_selection.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "core/float_environment.h"
#include "kernels/pkd_positions.h"

namespace insitu {
namespace {

using kernels::PkdTree;
using kernels::SelectedPlaces;

// The words of the two lowest levels, as far as there are two: a task writes whole words of both.
struct LowestLevels {
  std::uint64_t* places;
  std::uint64_t* blocks;  // nullptr: the places fit in one word
};

template <class Positions>
class Pass {
 public:
  Pass(const PkdTree& tree, const ParticleSelection::Word& word, const LowestLevels& out)
      : tree_(tree), positions_(tree), word_(word), out_(out) {}

  // The blocks of word `number` of the level above theirs.
  void run(std::uint64_t number, ScanResult& found) const {
    std::uint64_t any = 0;
    const std::uint64_t first = 64 * number;
    const std::uint64_t end = std::min(first + 64, SelectedPlaces::words(tree_.count));
    FilterBlock block;
    for (std::uint64_t k = first; k < end; ++k) {
      const std::uint64_t begin = FilterBlock::most * k;
      look_up(tree_, begin, std::min(FilterBlock::most, tree_.count - begin), block);
      const std::uint64_t word = word_(block);
      out_.places[k] = word;
      any |= std::uint64_t{word != 0} << (k - first);
      include(begin, word, block, found);
    }
    if (out_.blocks != nullptr) out_.blocks[number] = any;
  }

 private:
  void include(std::uint64_t begin, std::uint64_t word, const FilterBlock& block, ScanResult& found) const {
    found.drawn += static_cast<std::uint64_t>(std::popcount(word));
    const bool each_radius = tree_.radius.kind != kernels::RadiusView::Kind::uniform;
    for (; word != 0; word &= word - 1) {
      const auto i = static_cast<std::uint64_t>(std::countr_zero(word));
      for (int c = 0; c < 3; ++c) {
        const auto x = static_cast<double>(positions_.key(begin + i, c));
        found.lower[c] = std::min(found.lower[c], x);
        found.upper[c] = std::max(found.upper[c], x);
      }
      const double radius = each_radius ? tree_.radius.value(block.item[i]) : tree_.radius.uniform;
      found.radius_min = std::min(found.radius_min, radius);
      found.radius_max = std::max(found.radius_max, radius);
    }
  }

  const PkdTree& tree_;
  const Positions positions_;
  const ParticleSelection::Word& word_;
  const LowestLevels out_;
};

template <class Positions>
ScanResult select_in(const PkdTree& tree, const ParticleSelection::Word& word, const LowestLevels& out) {
  const Pass<Positions> pass(tree, word, out);
  const std::uint64_t tasks = SelectedPlaces::words(SelectedPlaces::words(tree.count));
  return tbb::parallel_reduce(
      tbb::blocked_range<std::uint64_t>(0, tasks), nothing_found(),
      [&](const auto& range, ScanResult found) {
        const FloatEnvironment guard;
        for (std::uint64_t number = range.begin(); number < range.end(); ++number) pass.run(number, found);
        return found;
      },
      joined);
}

ScanResult select(const PkdTree& tree, const ParticleSelection::Word& word, const LowestLevels& out) {
  switch (layout_of(tree)) {
    case kernels::PkdLayout::placed_f32:
      return select_in<kernels::PlacedPositions<float>>(tree, word, out);
    case kernels::PkdLayout::placed_f64:
      return select_in<kernels::PlacedPositions<double>>(tree, word, out);
    case kernels::PkdLayout::indexed_f32:
      return select_in<kernels::IndexedPositions<float>>(tree, word, out);
    case kernels::PkdLayout::indexed_f64:
      return select_in<kernels::IndexedPositions<double>>(tree, word, out);
    case kernels::PkdLayout::general:
      return select_in<kernels::GeneralPositions>(tree, word, out);
  }
  return nothing_found();
}

}  // namespace

void ParticleSelection::build(Budget& budget, const PkdTree& tree, const ParticleSelection::Word& word) {
  // A set without particles has a word of its own all the same: it says that none is drawn.
  std::uint64_t begin[SelectedPlaces::most_levels];
  std::uint64_t sizes[SelectedPlaces::most_levels];
  unsigned levels = 0;
  std::uint64_t total = 0;
  for (std::uint64_t size = std::max<std::uint64_t>(tree.count, 1); levels == 0 || size > 1; ++levels) {
    size = SelectedPlaces::words(size);
    sizes[levels] = size;
    begin[levels] = total;
    total += size + 1;  // a word to be read along
  }
  places_ = {};
  words_.reset(budget, total, "the filter of the particles");
  std::uint64_t* const words = words_.data();
  words[0] = 0;
  found_ = select(tree, word, {words, levels > 1 ? words + begin[1] : nullptr});
  for (unsigned l = 2; l < levels; ++l) {
    for (std::uint64_t number = 0; number < sizes[l]; ++number) {
      std::uint64_t any = 0;
      for (std::uint64_t k = 0; k < std::min<std::uint64_t>(64, sizes[l - 1] - 64 * number); ++k)
        any |= std::uint64_t{words[begin[l - 1] + 64 * number + k] != 0} << k;
      words[begin[l] + number] = any;
    }
  }
  for (unsigned l = 0; l < levels; ++l) places_.level[l] = words + begin[l];
  places_in_tree_ = tree.count;
  places_.thinning = thinning_of(tree.count);
}

// So that runs of 64 << thinning places have 64 that are drawn, or half as many.
unsigned ParticleSelection::thinning_of(std::uint64_t count) const {
  std::uint64_t blocks = 0;
  for (std::uint64_t k = 0; k < SelectedPlaces::words(count); ++k) blocks += places_.level[0][k] != 0 ? 1 : 0;
  unsigned thinning = 0;
  while (blocks != 0 && found_.drawn << (thinning + 1) <= FilterBlock::most * blocks) ++thinning;
  return thinning;
}

double ParticleSelection::run_length_for(double wanted) const {
  // Bits of a word of the second level: where there are no copies, all places of a run are looked at.
  constexpr double longest = 4096.0;
  std::vector<bool> any(SelectedPlaces::words(places_in_tree_));
  for (std::size_t k = 0; k < any.size(); ++k) any[k] = places_.level[0][k] != 0;
  double length = FilterBlock::most;
  for (;; length *= 2.0) {
    // What a run has that has any; of one twice as long it may be more.
    const auto runs = static_cast<double>(std::count(any.begin(), any.end(), true));
    const double held = static_cast<double>(found_.drawn) / std::max(runs, 1.0);
    if (2.0 * held > wanted || length >= longest) return std::min(length * wanted / std::max(held, 1.0), longest);
    for (std::size_t k = 0; 2 * k < any.size(); ++k) any[k] = any[2 * k] || (2 * k + 1 < any.size() && any[2 * k + 1]);
    any.resize((any.size() + 1) / 2);
  }
}

void ParticleSelection::clear() {
  places_ = {};
  words_.clear();
  found_ = nothing_found();
}

}  // namespace insitu
