#include "unit/kernels/test_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "geometry/particles/particle_scan.h"
#include "geometry/pkd/pkd_build.h"

namespace insitu::testing {
namespace {

using kernels::ArrayView;
using kernels::RadiusView;
using kernels::Scalar;

bool is_larger(const void*, std::uint64_t a, std::uint64_t b) { return a > b; }

constexpr double lattice_edge = 1 << 20;  // of integer layouts

struct LayoutRule {
  Scalar type;
  std::ptrdiff_t stride;  // 0: columns or rows
  std::ptrdiff_t first;   // bytes before the first scalar of a record
  bool rows;
};

LayoutRule rule_of(Layout layout) {
  switch (layout) {
    case Layout::records_f32:
      return {Scalar::f32, 12, 0, false};
    case Layout::records_f64:
      return {Scalar::f64, 24, 0, false};
    case Layout::strided_f32:
      return {Scalar::f32, 44, 8, false};
    case Layout::strided_f64:
      return {Scalar::f64, 72, 16, false};
    case Layout::columns_f32:
      return {Scalar::f32, 0, 0, false};
    case Layout::columns_f64:
      return {Scalar::f64, 0, 0, false};
    case Layout::records_i32:
      return {Scalar::i32, 12, 0, false};
    case Layout::records_u32:
      return {Scalar::u32, 12, 0, false};
    case Layout::rows_f32:
      return {Scalar::f32, 0, 0, true};
    case Layout::rows_f64:
      return {Scalar::f64, 0, 0, true};
  }
  return {};
}

// Stores `value` as the type holds it, and returns what is held.
double store(Scalar type, std::byte* at, double value) {
  const auto put = [&](auto scalar) {
    std::memcpy(at, &scalar, sizeof scalar);
    return static_cast<double>(scalar);
  };
  switch (type) {
    case Scalar::f32:
      return put(static_cast<float>(value));
    case Scalar::i32:
      return put(static_cast<std::int32_t>(std::floor(value)));
    case Scalar::u32:
      return put(static_cast<std::uint32_t>(std::floor(value)));
    default:
      return put(value);
  }
}

}  // namespace

const char* name_of(Shape shape) {
  constexpr const char* names[] = {"uniform", "clustered",  "planar",           "collinear",
                                   "grid",    "coincident", "coincident_groups"};
  return names[static_cast<int>(shape)];
}
const char* name_of(Layout layout) {
  constexpr const char* names[] = {"records_f32", "records_f64", "strided_f32", "strided_f64", "columns_f32",
                                   "columns_f64", "records_i32", "records_u32", "rows_f32",    "rows_f64"};
  return names[static_cast<int>(layout)];
}
const char* name_of(Order order) {
  constexpr const char* names[] = {"placed", "index32", "index64", "copy"};
  return names[static_cast<int>(order)];
}
const char* name_of(Radii radii) {
  constexpr const char* names[] = {"uniform", "per_item", "by_type"};
  return names[static_cast<int>(radii)];
}

std::ostream& operator<<(std::ostream& out, const TreeCase& c) {
  return out << c.count << " particles, " << name_of(c.shape) << ", " << name_of(c.layout) << ", " << name_of(c.order)
             << ", radii " << name_of(c.radii) << ", size " << c.size << ", offset " << c.offset << ", thickness "
             << c.thickness << ", seed " << c.seed;
}

std::vector<double> make_cloud(Shape shape, std::uint64_t count, double size, CounterRandom& random) {
  std::vector<double> x(3 * count);
  const auto anywhere = [&] { return size * random.between(-0.5, 0.5); };
  double axis[2][3];
  random.direction(axis[0]);
  random.direction(axis[1]);
  const auto edge = static_cast<std::uint64_t>(std::ceil(std::cbrt(static_cast<double>(count))));
  const std::uint64_t groups = 1 + count / 40;
  std::vector<double> centre(3 * groups);
  for (double& c : centre) c = anywhere();
  const double point[3] = {anywhere(), anywhere(), anywhere()};
  for (std::uint64_t i = 0; i < count; ++i) {
    const double a = anywhere();
    const double b = anywhere();
    const std::uint64_t cell[3] = {i % edge, i / edge % edge, i / (edge * edge)};
    const double spread = 0.02 * size * random.unit() * random.unit();
    double away[3];
    random.direction(away);
    const std::uint64_t group = random.below(groups);
    for (std::uint64_t c = 0; c < 3; ++c) {
      double& at = x[3 * i + c];
      switch (shape) {
        case Shape::uniform:
          at = anywhere();
          break;
        case Shape::clustered:
          at = centre[3 * (group % (1 + groups / 8)) + c] + spread * away[c];
          break;
        case Shape::planar:
          at = 0.5 * (a * axis[0][c] + b * axis[1][c]);
          break;
        case Shape::collinear:
          at = a * axis[0][c];
          break;
        case Shape::grid:
          at = size * ((static_cast<double>(cell[c]) + 0.5) / static_cast<double>(edge) - 0.5);
          break;
        case Shape::coincident:
          at = point[c];
          break;
        case Shape::coincident_groups:
          at = centre[3 * group + c];
          break;
      }
    }
  }
  return x;
}

TestTree::TestTree(const TreeCase& description) {
  lay_out(description);
  set_radii(description);
  if (description.larger_id_first) tree_.prefer = is_larger;
  const ScanResult scan = scan_particles(tree_, true);
  std::copy_n(scan.lower, 3, tree_.lower);
  std::copy_n(scan.upper, 3, tree_.upper);
  tree_.radius_max = scan.radius_max;
  tree_.count = scan.drawn;
  put_in_order(description.order);
}

void TestTree::lay_out(const TreeCase& description) {
  CounterRandom random(description.seed);
  const LayoutRule rule = rule_of(description.layout);
  const bool integers = rule.type == Scalar::i32 || rule.type == Scalar::u32;
  const std::uint64_t count = description.count;
  size_ = integers ? lattice_edge : description.size;
  const double offset = rule.type == Scalar::u32 ? 3e9 : integers ? -5e8 : description.offset;
  given_ = make_cloud(description.shape, count, size_, random);

  const auto size = static_cast<std::ptrdiff_t>(kernels::size_of(rule.type));
  ArrayView& view = tree_.position;
  view.type = rule.type;
  view.count = count;
  view.components = 3;
  view.rows = rule.rows;
  view.stride = rule.stride != 0 ? rule.stride : rule.rows ? static_cast<std::ptrdiff_t>(sizeof(void*)) : size;
  const auto allocate = [&](std::ptrdiff_t bytes) {
    memory_.push_back(std::make_unique<std::byte[]>(static_cast<std::size_t>(bytes)));
    return memory_.back().get();
  };
  if (count == 0) return;
  const auto n = static_cast<std::ptrdiff_t>(count);
  const auto last = static_cast<std::ptrdiff_t>(count - 1);
  std::byte* base[3] = {};
  if (rule.rows) {
    // Neighbours in the table are no neighbours in memory.
    std::byte* data = allocate(3 * size * n);
    std::byte* table = allocate(static_cast<std::ptrdiff_t>(sizeof(void*)) * n);
    for (std::ptrdiff_t i = 0; i < n; ++i) {
      const std::byte* row = data + 3 * size * (i % 2 == 0 ? i / 2 : last - i / 2);
      std::memcpy(table + i * view.stride, &row, sizeof row);
    }
    view.base[0] = view.base[1] = view.base[2] = table;
    columns_.push_back({table, view.stride, static_cast<std::size_t>(3 * size), true});
  } else if (rule.stride == 0) {
    for (int c = 0; c < 3; ++c) {
      view.base[c] = base[c] = allocate(size * n);
      columns_.push_back({base[c], size, static_cast<std::size_t>(size), false});
    }
  } else {
    std::byte* records = allocate(rule.first + rule.stride * last + 3 * size) + rule.first;
    for (int c = 0; c < 3; ++c) view.base[c] = base[c] = records + c * size;
    columns_.push_back({records, rule.stride, static_cast<std::size_t>(3 * size), false});
  }
  for (std::uint64_t i = 0; i < count; ++i)
    for (std::uint32_t c = 0; c < 3; ++c)
      given_[3 * i + c] = store(rule.type, const_cast<std::byte*>(view.address(i, c)), given_[3 * i + c] + offset);
}

void TestTree::set_radii(const TreeCase& description) {
  CounterRandom random(description.seed + 1000003);
  const std::uint64_t count = description.count;
  const double typical =
      0.4 * description.thickness * size_ / std::cbrt(static_cast<double>(std::max<std::uint64_t>(count, 1)));
  RadiusView& radius = tree_.radius;
  switch (description.radii) {
    case Radii::uniform:
      radius.uniform = typical;
      break;
    case Radii::per_item: {
      radius.kind = RadiusView::Kind::per_item;
      radius.scale = 0.5;
      memory_.push_back(std::make_unique<std::byte[]>(8 * count));
      radius.array.base[0] = memory_.back().get();
      radius.array.stride = 8;
      radius.array.type = Scalar::f64;
      for (std::uint64_t i = 0; i < count; ++i)
        store(Scalar::f64, memory_.back().get() + 8 * i, 2.0 * typical * random.magnitude(-3.0, 0.5));
      if (description.order == Order::placed && count > 0) columns_.push_back({memory_.back().get(), 8, 8, false});
      break;
    }
    case Radii::by_type: {
      radius.kind = RadiusView::Kind::by_type;
      type_radius_ = {typical, 0.3 * typical, 1.7 * typical};
      radius.table = type_radius_.data();
      radius.table_size = type_radius_.size();
      memory_.push_back(std::make_unique<std::byte[]>(count));
      radius.array.base[0] = memory_.back().get();
      radius.array.stride = 1;
      radius.array.type = Scalar::u8;
      for (std::uint64_t i = 0; i < count; ++i) memory_.back()[i] = static_cast<std::byte>(random.below(3));
      if (description.order == Order::placed && count > 0) columns_.push_back({memory_.back().get(), 1, 1, false});
      break;
    }
  }
  radius.array.count = count;
  radius.array.components = 1;
  for (std::uint64_t i = 0; i < count; ++i) given_radius_.push_back(radius.value(i));
}

void TestTree::put_in_order(Order order) {
  const std::uint64_t count = tree_.position.count;
  if (order == Order::index64) {
    for (std::uint64_t i = 0; i < count; ++i) index64_.push_back(i);
    tree_.index64 = index64_.data();
    tree_.position_by_place = false;
    build_index(tree_, index64_.data());
    return;
  }
  for (std::uint64_t i = 0; i < count; ++i) index32_.push_back(static_cast<std::uint32_t>(i));
  if (order == Order::index32) {
    tree_.index32 = index32_.data();
    tree_.position_by_place = false;
    build_index(tree_, index32_.data());
    return;
  }
  std::vector<std::uint32_t>& along = order == Order::copy ? index32_ : who_;
  const MovedColumn numbers = {reinterpret_cast<std::byte*>(along.data()), 4, 4, false};
  if (order == Order::copy) {
    tree_.index32 = index32_.data();
    columns_.push_back(numbers);
    build_columns(tree_, columns_);
    return;
  }
  // Packed coordinates alone take a path of their own in the build, so nothing moves along with those.
  const bool packed_f32 = tree_.position.type == Scalar::f32 && tree_.position.stride == 12;
  const bool packed_f64 = tree_.position.type == Scalar::f64 && tree_.position.stride == 24;
  const bool alone = columns_.size() == 1 && (packed_f32 || packed_f64);
  if (!alone) {
    who_ = index32_;
    columns_.push_back({reinterpret_cast<std::byte*>(who_.data()), 4, 4, false});
  }
  index32_.clear();
  build_columns(tree_, columns_);
}

std::uint64_t TestTree::original(std::uint64_t place) const {
  if (!index64_.empty()) return index64_[place];
  return index32_.empty() ? who_.at(place) : index32_[place];
}

}  // namespace insitu::testing
