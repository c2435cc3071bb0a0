#include "geometry/sticks/arrows.h"

namespace insitu {

bool ArrowSource::is_good(std::uint64_t item) const {
  double point[3];
  if (!points.point(item, point)) return false;
  double squares = 0.0;
  for (std::uint32_t c = 0; c < 3; ++c) {
    const double v = vectors.value(item, c) * scale;
    squares += v * v;
  }
  return squares <= 1e200;  // as far as positions may go
}

bool ArrowSource::stick(std::uint64_t id, kernels::Stick& out) const {
  const std::uint64_t item = id / 2;
  double tail[3];
  double vector[3];
  if (!points.point(item, tail)) return false;
  double squares = 0.0;
  for (std::uint32_t c = 0; c < 3; ++c) {
    vector[c] = vectors.value(item, c) * scale;
    squares += vector[c] * vector[c];
  }
  if (!(squares > 0.0 && squares <= 1e200)) return false;
  const double length = std::sqrt(squares);
  const double head = std::min(head_length, length);
  const bool is_head = id % 2 != 0;
  const double neck = 1.0 - head / length;  // where shaft and head meet, in parts of the arrow
  out.ends = is_head ? kernels::StickEnds::cone : kernels::StickEnds::flat;
  out.radius = is_head ? head_radius * (head_length > 0.0 ? head / head_length : 0.0) : radius;
  bool has_length = false;
  for (int c = 0; c < 3; ++c) {
    if (centred) tail[c] -= 0.5 * vector[c];
    out.a[c] = is_head ? tail[c] + neck * vector[c] : tail[c];
    out.b[c] = is_head ? tail[c] + vector[c] : tail[c] + neck * vector[c];
    has_length = has_length || out.a[c] != out.b[c];
  }
  return has_length && out.radius > 0.0;
}

bool ArrowSource::prefer(std::uint64_t a, std::uint64_t b) const {
  kernels::Stick x{};
  kernels::Stick y{};
  stick(a, x);
  stick(b, y);
  const int order = compare(x, y);
  if (order != 0) return order < 0;
  return a / 2 != b / 2 ? points.prefers(a / 2, b / 2) : a < b;
}

}  // namespace insitu
