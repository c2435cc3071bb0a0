#include "geometry/particles/particle_scan.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "core/float_environment.h"
#include "kernels/pkd_partition.h"
#include "kernels/pkd_positions.h"

namespace insitu {
namespace {

bool is_good_radius(double radius) { return radius > 0.0 && radius <= largest_coordinate; }

// Packed records without a radius each, all of them fit to be drawn: by SIMD. False, and nothing done, otherwise.
template <class Positions>
bool scan_records(const Positions& positions, std::uint64_t begin, std::uint64_t end, ScanResult& result) {
  if constexpr (std::is_same_v<Positions, kernels::PlacedPositions<typename Positions::Key>>) {
    if (!positions.packed_records()) return false;
    typename Positions::Key lower[3];
    typename Positions::Key upper[3];
    if (!kernels::bounds_of_records(positions.scalars(begin, 0), static_cast<std::size_t>(end - begin), lower, upper))
      return false;
    ScanResult range = nothing_found();
    range.drawn = end - begin;
    for (int c = 0; c < 3; ++c) {
      range.lower[c] = static_cast<double>(lower[c]);
      range.upper[c] = static_cast<double>(upper[c]);
      if (range.lower[c] < -largest_coordinate || range.upper[c] > largest_coordinate) return false;
    }
    result = joined(result, range);
    return true;
  }
  return false;
}

template <class Positions>
ScanResult scan(const kernels::PkdTree& tree, bool judge_radius) {
  const Positions positions(tree);
  const bool each_radius = judge_radius && tree.radius.kind != kernels::RadiusView::Kind::uniform;
  const auto scan_range = [&](const tbb::blocked_range<std::uint64_t>& range, ScanResult result) {
    const FloatEnvironment guard;
    if (!each_radius && scan_records(positions, range.begin(), range.end(), result)) return result;
    for (std::uint64_t item = range.begin(); item < range.end(); ++item) {
      double centre[3];
      positions.centre(item, centre);
      // False for NaN as well.
      const bool inside = std::abs(centre[0]) <= largest_coordinate && std::abs(centre[1]) <= largest_coordinate &&
                          std::abs(centre[2]) <= largest_coordinate;
      if (!inside) continue;
      if (each_radius) {
        const double radius = tree.radius.value(item);
        if (!is_good_radius(radius)) continue;
        result.radius_min = std::min(result.radius_min, radius);
        result.radius_max = std::max(result.radius_max, radius);
      }
      for (int c = 0; c < 3; ++c) {
        result.lower[c] = std::min(result.lower[c], centre[c]);
        result.upper[c] = std::max(result.upper[c], centre[c]);
      }
      ++result.drawn;
    }
    return result;
  };
  constexpr std::uint64_t grain = 1 << 16;
  ScanResult result = tbb::parallel_reduce(tbb::blocked_range<std::uint64_t>(0, tree.position.count, grain),
                                           nothing_found(), scan_range, joined);
  if (!each_radius && judge_radius) {
    if (!is_good_radius(tree.radius.uniform)) return nothing_found();
    result.radius_min = result.radius_max = tree.radius.uniform;
  }
  return result;
}

}  // namespace

ScanResult joined(const ScanResult& a, const ScanResult& b) {
  ScanResult both = a;
  for (int c = 0; c < 3; ++c) {
    both.lower[c] = std::min(a.lower[c], b.lower[c]);
    both.upper[c] = std::max(a.upper[c], b.upper[c]);
  }
  both.radius_min = std::min(a.radius_min, b.radius_min);
  both.radius_max = std::max(a.radius_max, b.radius_max);
  both.drawn = a.drawn + b.drawn;
  return both;
}

bool is_drawable(const kernels::PkdTree& tree, std::uint64_t item) {
  for (std::uint32_t c = 0; c < 3; ++c)
    if (!(std::abs(tree.position.value(item, c)) <= largest_coordinate)) return false;
  return is_good_radius(tree.radius.value(item));
}

ScanResult scan_particles(const kernels::PkdTree& tree, bool judge_radius) {
  kernels::PkdTree by_item = tree;
  by_item.index32 = nullptr;
  by_item.index64 = nullptr;
  by_item.position_by_place = true;
  switch (layout_of(by_item)) {
    case kernels::PkdLayout::placed_f32:
      return scan<kernels::PlacedPositions<float>>(by_item, judge_radius);
    case kernels::PkdLayout::placed_f64:
      return scan<kernels::PlacedPositions<double>>(by_item, judge_radius);
    default:
      return scan<kernels::GeneralPositions>(by_item, judge_radius);
  }
}

}  // namespace insitu
