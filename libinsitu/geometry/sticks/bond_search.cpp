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

constexpr std::uint64_t most_pairs = std::uint64_t{1} << 31;
constexpr std::uint32_t no_cell = ~0u;

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
    }
  }

  std::uint64_t cells() const { return std::uint64_t{count_[0]} * count_[1] * count_[2]; }

  std::uint32_t cell_of(const double point[3], std::uint32_t at[3]) const {
    double fraction[3];
    frame_.fraction_of(point, fraction);
    for (int i = 0; i < 3; ++i) {
      double f = fraction[i] - low_[i];
      if (periodic_[i]) f -= std::floor(f);
      const double place = extent_[i] > 0.0 ? f / extent_[i] * count_[i] : 0.0;
      at[i] = static_cast<std::uint32_t>(std::clamp(std::floor(place), 0.0, static_cast<double>(count_[i] - 1)));
    }
    return number(at);
  }

  // Calls action(cell) once for each cell around `at`, itself included.
  template <class Action>
  void around(const std::uint32_t at[3], Action&& action) const {
    std::uint32_t near[3][3];
    unsigned n[3];
    for (int i = 0; i < 3; ++i) n[i] = along(i, at[i], near[i]);
    for (unsigned z = 0; z < n[2]; ++z)
      for (unsigned y = 0; y < n[1]; ++y)
        for (unsigned x = 0; x < n[0]; ++x) {
          const std::uint32_t cell[3] = {near[0][x], near[1][y], near[2][z]};
          action(number(cell));
        }
  }

 private:
  std::uint32_t number(const std::uint32_t at[3]) const { return (at[2] * count_[1] + at[1]) * count_[0] + at[0]; }

  unsigned along(int axis, std::uint32_t at, std::uint32_t near[3]) const {
    const std::uint32_t count = count_[axis];
    unsigned n = 0;
    for (int step = -1; step <= 1; ++step) {
      if (!periodic_[axis] && ((step < 0 && at == 0) || (step > 0 && at + 1 == count))) continue;
      const std::uint32_t cell = (at + count + static_cast<std::uint32_t>(step)) % count;
      if (std::find(near, near + n, cell) == near + n) near[n++] = cell;
    }
    return n;
  }

  Cell frame_;
  bool periodic_[3];
  double low_[3];
  double extent_[3];
  std::uint32_t count_[3];
};

}  // namespace

void find_bonds(Budget& budget, const ParticlePoints& points, const BondSearch& search,
                BudgetVector<std::uint32_t>& pairs) {
  const double reach = search.cutoff > 0.0 ? search.cutoff : 2.0 * search.by_radius * search.radius_max * points.scale;
  const std::uint64_t count = points.count();
  pairs.clear();
  if (count == 0 || !(reach > 0.0)) return;
  if (count > no_cell) throw Error(INSITU_ERROR_UNSUPPORTED, "bonds by distance: more than 2^32 - 1 particles");
  if (search.periodic) {
    for (int i = 0; i < 3; ++i)
      if (points.cell->periodic[i] && !(reach < 0.5 * points.cell->height(i)))
        throw Error(INSITU_ERROR_INVALID_ARGUMENT,
                    "bonds by distance: " + std::to_string(reach) +
                        ", the longest bond, is not below half the height of the periodic cell, " +
                        std::to_string(points.cell->height(i)) + ": two particles would be bonded twice");
  }
  const Grid grid(points, reach, search.periodic);
  const std::uint64_t cells = grid.cells();
  BudgetVector<std::uint32_t> cell_of;
  BudgetVector<std::uint32_t> first;  // of each cell, in `sorted`
  BudgetVector<std::uint32_t> sorted;
  BudgetVector<std::uint32_t> partners;
  cell_of.reset(budget, count, "the search for bonds");
  first.reset(budget, cells + 1, "the search for bonds");
  sorted.reset(budget, count, "the search for bonds");
  partners.reset(budget, count, "the search for bonds");
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, count, 4096), [&](const auto& range) {
    for (std::uint64_t item = range.begin(); item < range.end(); ++item) {
      double point[3];
      std::uint32_t at[3];
      cell_of.data()[item] = points.point(item, point) ? grid.cell_of(point, at) : no_cell;
    }
  });
  for (std::uint64_t item = 0; item < count; ++item)
    if (cell_of.data()[item] != no_cell) ++first.data()[cell_of.data()[item] + 1];
  for (std::uint64_t cell = 0; cell < cells; ++cell) first.data()[cell + 1] += first.data()[cell];
  std::vector<std::uint32_t> next(first.data(), first.data() + cells);
  for (std::uint64_t item = 0; item < count; ++item)
    if (cell_of.data()[item] != no_cell) sorted.data()[next[cell_of.data()[item]]++] = static_cast<std::uint32_t>(item);

  // action(partner) for every partner behind `item`, in no particular order.
  const auto each_partner = [&](std::uint64_t item, auto&& action) {
    double from[3];
    std::uint32_t at[3];
    if (!points.point(item, from)) return;
    grid.cell_of(from, at);
    const double radius = search.cutoff > 0.0 ? 0.0 : search.radius.value(item);
    grid.around(at, [&](std::uint32_t cell) {
      for (std::uint32_t k = first.data()[cell]; k < first.data()[cell + 1]; ++k) {
        const std::uint32_t other = sorted.data()[k];
        if (other <= item) continue;
        double d[3];
        points.point(other, d);
        for (int c = 0; c < 3; ++c) d[c] -= from[c];
        if (search.periodic) points.cell->nearest_image(d);
        const double distance = std::hypot(d[0], d[1], d[2]);
        const double most = search.cutoff > 0.0
                                ? search.cutoff
                                : search.by_radius * (radius + search.radius.value(other)) * points.scale;
        if (distance > 0.0 && distance < most) action(other);
      }
    });
  };
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, count, 256), [&](const auto& range) {
    for (std::uint64_t item = range.begin(); item < range.end(); ++item) {
      std::uint32_t n = 0;
      each_partner(item, [&n](std::uint32_t) { ++n; });
      partners.data()[item] = n;
    }
  });
  std::vector<std::uint64_t> begin(count + 1);
  for (std::uint64_t item = 0; item < count; ++item) begin[item + 1] = begin[item] + partners.data()[item];
  if (begin[count] >= most_pairs) throw Error(INSITU_ERROR_UNSUPPORTED, "bonds by distance: more than 2^31 bonds");
  pairs.reset(budget, 2 * begin[count], "the bonds");
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, count, 256), [&](const auto& range) {
    for (std::uint64_t item = range.begin(); item < range.end(); ++item) {
      std::vector<std::uint32_t> own;
      each_partner(item, [&own](std::uint32_t other) { own.push_back(other); });
      std::sort(own.begin(), own.end());
      std::uint32_t* out = pairs.data() + 2 * begin[item];
      for (const std::uint32_t other : own) {
        *out++ = static_cast<std::uint32_t>(item);
        *out++ = other;
      }
    }
  });
}

}  // namespace insitu
