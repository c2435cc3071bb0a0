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

bool is_before(const double a[3], const double b[3]) {
  for (int c = 0; c < 3; ++c)
    if (a[c] != b[c]) return a[c] < b[c];
  return false;
}

}  // namespace

bool BondSource::ends_of(std::uint64_t pair, std::uint64_t item[2], double point[2][3]) const {
  for (std::uint32_t k = 0; k < 2; ++k) {
    item[k] = found != nullptr ? found[2 * pair + k] : index_at(pairs, pair, k);
    if (item[k] >= points.count() || !points.point(item[k], point[k])) return false;
  }
  if (item[0] == item[1]) return false;
  if (is_before(point[1], point[0])) {
    std::swap(item[0], item[1]);
    for (int c = 0; c < 3; ++c) std::swap(point[0][c], point[1][c]);
  }
  return true;
}

bool BondSource::stick(std::uint64_t id, kernels::Stick& out) const {
  std::uint64_t item[2];
  double point[2][3];
  if (!ends_of(id / 2, item, point)) return false;
  double d[3];
  for (int c = 0; c < 3; ++c) d[c] = point[1][c] - point[0][c];
  const bool second = id % 2 != 0;
  out.radius = radius;
  out.ends = ends;
  bool has_length = false;
  if (periodic && points.cell->nearest_image(d)) {
    for (int c = 0; c < 3; ++c) {
      out.a[c] = point[second ? 1 : 0][c];
      out.b[c] = out.a[c] + (second ? -0.5 : 0.5) * d[c];
      has_length = has_length || out.a[c] != out.b[c];
    }
    return has_length;
  }
  if (second) return false;
  for (int c = 0; c < 3; ++c) {
    out.a[c] = point[0][c];
    out.b[c] = point[1][c];
    has_length = has_length || out.a[c] != out.b[c];
  }
  return has_length;
}

bool BondSource::is_good(std::uint64_t pair) const {
  kernels::Stick stick;
  return this->stick(2 * pair, stick);
}

std::uint64_t BondSource::color_item(std::uint64_t id, double along) const {
  std::uint64_t item[2];
  double point[2][3];
  if (!ends_of(id / 2, item, point)) return 0;
  double d[3];
  for (int c = 0; c < 3; ++c) d[c] = point[1][c] - point[0][c];
  if (periodic && points.cell->nearest_image(d)) return item[id % 2];
  return item[along < 0.5 ? 0 : 1];
}

bool BondSource::prefer(std::uint64_t a, std::uint64_t b) const {
  kernels::Stick x{};
  kernels::Stick y{};
  stick(a, x);
  stick(b, y);
  const int order = compare(x, y);
  if (order != 0) return order < 0;
  for (const double along : {0.0, 1.0}) {
    const std::uint64_t p = color_item(a, along);
    const std::uint64_t q = color_item(b, along);
    if (p != q) return points.prefers(p, q);
  }
  return a < b;
}

}  // namespace insitu
