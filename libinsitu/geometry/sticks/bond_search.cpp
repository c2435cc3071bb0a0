// A cell list (Hockney and Eastwood, "Computer Simulation Using Particles", 1981, section 8.4.1): the particles sorted
// into cells not smaller than the longest bond, so that partners stand in the same or a neighbouring one.
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/error.h"
#include "geometry/sticks/bonds.h"

namespace insitu {
namespace {

constexpr std::uint64_t most_bonds = std::uint64_t{1} << 31;
constexpr std::uint32_t no_cell = ~0u;
constexpr double most_images = 10.0;

// One of each two opposite vectors.
bool points_backwards(const double d[3]) {
  if (d[0] != 0.0) return d[0] < 0.0;
  return d[1] != 0.0 ? d[1] < 0.0 : d[2] < 0.0;
}

// Cells along the edges of the simulation's cell where that repeats, else of the box of the particles.
class Grid {
 public:
  Grid(const ParticlePoints& points, double reach, bool periodic) {
    if (points.cell) frame_ = *points.cell;
    if (!points.cell) {
      for (int i = 0; i < 3; ++i) frame_.edge[i][i] = 1.0;
      frame_.prepare();
    }
    double low[3];
    double high[3];
    for (int i = 0; i < 3; ++i) {
      low[i] = std::numeric_limits<double>::infinity();
      high[i] = -low[i];
    }
    std::uint64_t drawn = 0;
    double point[3];
    double fraction[3];
    for (std::uint64_t item = 0; item < points.count(); ++item) {
      if (!points.point(item, point)) continue;
      ++drawn;
      frame_.fraction_of(point, fraction);
      for (int i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], fraction[i]);
        high[i] = std::max(high[i], fraction[i]);
      }
    }
    // No more cells than particles: empty ones are memory, too.
    const double most = std::max(1.0, std::cbrt(2.0 * static_cast<double>(drawn)));
    for (int i = 0; i < 3; ++i) {
      periodic_[i] = periodic && frame_.periodic[i];
      low_[i] = periodic_[i] || drawn == 0 ? 0.0 : low[i];
      extent_[i] = periodic_[i] ? 1.0 : drawn == 0 ? 0.0 : high[i] - low[i];
      // A little larger than the reach, for the roundings of fractions.
      const double fit = extent_[i] * frame_.height(i) / (reach * (1.0 + 1e-9));
      count_[i] = static_cast<std::uint32_t>(std::clamp(std::floor(fit), 1.0, std::floor(most)));
      // A cell that is smaller than the reach is met again and again, as its own images.
      const double cells = periodic_[i] && count_[i] == 1 ? std::ceil(reach * (1.0 + 1e-9) / frame_.height(i)) : 1.0;
      if (!(cells <= most_images))
        throw Error(INSITU_ERROR_INVALID_ARGUMENT,
                    "bonds by distance: bonds of up to " + std::to_string(reach) + " are longer than ten cells");
      steps_[i] = static_cast<std::int32_t>(cells);
    }
  }

  std::uint64_t cells() const { return std::uint64_t{count_[0]} * count_[1] * count_[2]; }

  // `image`: how many edges the point lies outside of the cell.
  std::uint32_t cell_of(const double point[3], std::int32_t at[3], double image[3]) const {
    double fraction[3];
    frame_.fraction_of(point, fraction);
    for (int i = 0; i < 3; ++i) {
      double f = fraction[i] - low_[i];
      image[i] = periodic_[i] ? std::floor(f) : 0.0;
      f -= image[i];
      const double place = extent_[i] > 0.0 ? f / extent_[i] * count_[i] : 0.0;
      at[i] = static_cast<std::int32_t>(std::clamp(std::floor(place), 0.0, static_cast<double>(count_[i] - 1)));
    }
    return number(at);
  }

  // Calls action(cell, image) once for each cell around `at`, itself included, and each image of it.
  template <class Action>
  void around(const std::int32_t at[3], Action&& action) const {
    std::int32_t step[3];
    std::int32_t cell[3];
    std::int32_t image[3];
    for (step[2] = -steps_[2]; step[2] <= steps_[2]; ++step[2]) {
      if (!move(2, at[2] + step[2], cell[2], image[2])) continue;
      for (step[1] = -steps_[1]; step[1] <= steps_[1]; ++step[1]) {
        if (!move(1, at[1] + step[1], cell[1], image[1])) continue;
        for (step[0] = -steps_[0]; step[0] <= steps_[0]; ++step[0])
          if (move(0, at[0] + step[0], cell[0], image[0])) action(number(cell), image);
      }
    }
  }

 private:
  std::uint32_t number(const std::int32_t at[3]) const {
    return static_cast<std::uint32_t>((std::int64_t{at[2]} * count_[1] + at[1]) * count_[0] + at[0]);
  }

  // False beyond the border of an axis that does not repeat.
  bool move(int axis, std::int32_t to, std::int32_t& cell, std::int32_t& image) const {
    const auto count = static_cast<std::int32_t>(count_[axis]);
    image = to < 0 ? -((count - 1 - to) / count) : to / count;
    cell = to - image * count;
    return periodic_[axis] || image == 0;
  }

  Cell frame_;
  bool periodic_[3];
  double low_[3];
  double extent_[3];
  std::uint32_t count_[3];
  std::int32_t steps_[3];  // cells to go to either side
};

}  // namespace

void find_bonds(Budget& budget, const ParticlePoints& points, const BondSearch& search,
                BudgetVector<FoundBond>& bonds) {
  const double reach = search.cutoff > 0.0 ? search.cutoff : 2.0 * search.by_radius * search.radius_max * points.scale;
  const std::uint64_t count = points.count();
  bonds.clear();
  if (count == 0 || !(reach > 0.0)) return;
  if (count > no_cell) throw Error(INSITU_ERROR_UNSUPPORTED, "bonds by distance: more than 2^32 - 1 particles");
  const Grid grid(points, reach, search.periodic);
  const std::uint64_t cells = grid.cells();
  BudgetVector<std::uint32_t> cell_of;
  BudgetVector<std::uint32_t> first;  // of each cell, in `sorted`
  BudgetVector<std::uint32_t> sorted;
  BudgetVector<std::uint64_t> begin;  // of each particle's bonds
  cell_of.reset(budget, count, "the search for bonds");
  first.reset(budget, cells + 1, "the search for bonds");
  sorted.reset(budget, count, "the search for bonds");
  begin.reset(budget, count + 1, "the search for bonds");
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, count, 4096), [&](const auto& range) {
    for (std::uint64_t item = range.begin(); item < range.end(); ++item) {
      double point[3];
      std::int32_t at[3];
      double image[3];
      cell_of.data()[item] =
          points.is_shown(item) && points.point(item, point) ? grid.cell_of(point, at, image) : no_cell;
    }
  });
  for (std::uint64_t item = 0; item < count; ++item)
    if (cell_of.data()[item] != no_cell) ++first.data()[cell_of.data()[item] + 1];
  for (std::uint64_t cell = 0; cell < cells; ++cell) first.data()[cell + 1] += first.data()[cell];
  std::vector<std::uint32_t> next(first.data(), first.data() + cells);
  for (std::uint64_t item = 0; item < count; ++item)
    if (cell_of.data()[item] != no_cell) sorted.data()[next[cell_of.data()[item]]++] = static_cast<std::uint32_t>(item);

  // action(bond) for every bond of which `item` is the smaller end, in no particular order.
  const auto each_bond = [&](std::uint64_t item, auto&& action) {
    double from[3] = {};
    double image_from[3];
    std::int32_t at[3];
    if (cell_of.data()[item] == no_cell || !points.point(item, from)) return;
    grid.cell_of(from, at, image_from);
    const double radius = search.cutoff > 0.0 ? 0.0 : search.radius.value(item);
    grid.around(at, [&](std::uint32_t cell, const std::int32_t step[3]) {
      for (std::uint32_t k = first.data()[cell]; k < first.data()[cell + 1]; ++k) {
        const std::uint32_t other = sorted.data()[k];
        if (other < item) continue;
        double d[3] = {};
        points.point(other, d);
        double image[3] = {};
        if (search.periodic) {
          std::int32_t unused[3];
          double image_other[3];
          double offset[3];
          grid.cell_of(d, unused, image_other);
          for (int i = 0; i < 3; ++i) image[i] = step[i] + image_from[i] - image_other[i];
          points.cell->offset_of(image, offset);
          for (int c = 0; c < 3; ++c) d[c] = (d[c] - from[c]) + offset[c];
        } else {
          for (int c = 0; c < 3; ++c) d[c] -= from[c];
        }
        // Of a particle and its own images one of each two opposite ones.
        if (other == item && !points_backwards(d)) continue;
        const double distance = std::hypot(d[0], d[1], d[2]);
        const double most = search.cutoff > 0.0
                                ? search.cutoff
                                : search.by_radius * (radius + search.radius.value(other)) * points.scale;
        if (!(distance > 0.0 && distance < most)) continue;
        FoundBond bond{static_cast<std::uint32_t>(item), other, {}};
        for (int i = 0; i < 3; ++i) bond.image[i] = static_cast<std::int32_t>(std::clamp(image[i], -2e9, 2e9));
        action(bond);
      }
    });
  };
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, count, 256), [&](const auto& range) {
    for (std::uint64_t item = range.begin(); item < range.end(); ++item) {
      std::uint64_t n = 0;
      each_bond(item, [&n](const FoundBond&) { ++n; });
      begin.data()[item + 1] = n;
    }
  });
  for (std::uint64_t item = 0; item < count; ++item) begin.data()[item + 1] += begin.data()[item];
  if (begin.data()[count] >= most_bonds)
    throw Error(INSITU_ERROR_UNSUPPORTED, "bonds by distance: more than 2^31 bonds");
  bonds.reset(budget, begin.data()[count], "the bonds");
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, count, 256), [&](const auto& range) {
    for (std::uint64_t item = range.begin(); item < range.end(); ++item) {
      FoundBond* const own = bonds.data() + begin.data()[item];
      FoundBond* out = own;
      each_bond(item, [&out](const FoundBond& bond) { *out++ = bond; });
      std::sort(own, out, [](const FoundBond& a, const FoundBond& b) {
        return a.b != b.b ? a.b < b.b : std::lexicographical_compare(a.image, a.image + 3, b.image, b.image + 3);
      });
    }
  });
}

}  // namespace insitu
