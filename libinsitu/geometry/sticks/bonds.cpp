#include "geometry/sticks/bonds.h"

namespace insitu {
namespace {

// Integers of any type without passing through double; negative ones become large.
std::uint64_t index_at(const kernels::ArrayView& view, std::uint64_t pair, std::uint32_t component) {
  const std::byte* address = view.address(pair, component);
  switch (view.type) {
    case kernels::Scalar::i32:
      return static_cast<std::uint64_t>(std::int64_t{kernels::load<std::int32_t>(address)});
    case kernels::Scalar::u32:
      return kernels::load<std::uint32_t>(address);
    default:
      return kernels::load<std::uint64_t>(address);
  }
}

int compare(const double a[3], const double b[3]) {
  for (int c = 0; c < 3; ++c)
    if (a[c] != b[c]) return a[c] < b[c] ? -1 : 1;
  return 0;
}

}  // namespace

bool BondSource::ends_of(std::uint64_t pair, Ends& ends) const {
  for (std::uint32_t k = 0; k < 2; ++k) {
    ends.item[k] = found == nullptr ? index_at(pairs, pair, k) : k == 0 ? found[pair].a : found[pair].b;
    if (ends.item[k] >= points.count() || !points.point(ends.item[k], ends.point[k])) return false;
  }
  for (int c = 0; c < 3; ++c) ends.d[c] = ends.point[1][c] - ends.point[0][c];
  ends.crosses = false;
  if (found != nullptr) {
    const std::int32_t* image = found[pair].image;
    ends.crosses = image[0] != 0 || image[1] != 0 || image[2] != 0;
    if (ends.crosses) {
      const double count[3] = {static_cast<double>(image[0]), static_cast<double>(image[1]),
                               static_cast<double>(image[2])};
      double offset[3];
      points.cell->offset_of(count, offset);
      for (int c = 0; c < 3; ++c) ends.d[c] += offset[c];
    }
  } else {
    if (ends.item[0] == ends.item[1]) return false;
    ends.crosses = periodic && points.cell->nearest_image(ends.d);
  }
  constexpr double zero[3] = {};
  const int order = compare(ends.point[0], ends.point[1]);
  if (order > 0 || (order == 0 && compare(ends.d, zero) < 0)) {
    std::swap(ends.item[0], ends.item[1]);
    for (int c = 0; c < 3; ++c) {
      std::swap(ends.point[0][c], ends.point[1][c]);
      ends.d[c] = -ends.d[c];
    }
  }
  return true;
}

bool BondSource::is_filtered(std::uint64_t pair) const {
  Ends ends;
  return found == nullptr && points.filter != nullptr && ends_of(pair, ends) &&
         !(points.is_shown(ends.item[0]) && points.is_shown(ends.item[1]));
}

bool BondSource::stick(std::uint64_t id, kernels::Stick& out) const {
  Ends ends;
  const bool second = id % 2 != 0;
  if (!ends_of(id / 2, ends) || (second && !ends.crosses)) return false;
  out.radius = radius;
  out.ends = this->ends;
  bool has_length = false;
  for (int c = 0; c < 3; ++c) {
    out.a[c] = ends.point[second ? 1 : 0][c];
    out.b[c] = ends.crosses ? out.a[c] + (second ? -0.5 : 0.5) * ends.d[c] : ends.point[1][c];
    has_length = has_length || out.a[c] != out.b[c];
  }
  return has_length;
}

std::uint64_t BondSource::color_item(std::uint64_t id, double along) const {
  Ends ends;
  if (!ends_of(id / 2, ends)) return 0;
  if (ends.crosses) return ends.item[id % 2];
  return ends.item[along < 0.5 ? 0 : 1];
}

bool BondSource::prefer(std::uint64_t a, std::uint64_t b) const {
  kernels::Stick x{};
  kernels::Stick y{};
  stick(a, x);
  stick(b, y);
  const int order = insitu::compare(x, y);
  if (order != 0) return order < 0;
  for (const double along : {0.0, 1.0}) {
    const std::uint64_t p = color_item(a, along);
    const std::uint64_t q = color_item(b, along);
    if (p != q) return points.prefers(p, q);
  }
  return a < b;
}

}  // namespace insitu
