// Trees for tests: a cloud of particles of some shape, laid out in memory as simulations do, and built.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "geometry/pkd/pkd_store.h"
#include "kernels/pkd_tree.h"
#include "unit/kernels/counter_random.h"

namespace insitu::testing {

enum class Shape { uniform, clustered, planar, collinear, grid, coincident, coincident_groups };
enum class Layout {
  records_f32,
  records_f64,
  strided_f32,
  strided_f64,
  columns_f32,
  columns_f64,
  records_i32,
  records_u32,
  rows_f32,
  rows_f64
};
enum class Order { placed, index32, index64, copy };
enum class Radii { uniform, per_item, by_type };

inline constexpr std::array all_shapes = {Shape::uniform, Shape::clustered,  Shape::planar,           Shape::collinear,
                                          Shape::grid,    Shape::coincident, Shape::coincident_groups};
inline constexpr std::array all_layouts = {
    Layout::records_f32, Layout::records_f64, Layout::strided_f32, Layout::strided_f64, Layout::columns_f32,
    Layout::columns_f64, Layout::records_i32, Layout::records_u32, Layout::rows_f32,    Layout::rows_f64};
inline constexpr std::array all_orders = {Order::placed, Order::index32, Order::index64, Order::copy};
inline constexpr std::array all_radii = {Radii::uniform, Radii::per_item, Radii::by_type};

const char* name_of(Shape shape);
const char* name_of(Layout layout);
const char* name_of(Order order);
const char* name_of(Radii radii);

struct TreeCase {
  std::uint64_t count = 0;
  Shape shape = Shape::uniform;
  Layout layout = Layout::records_f32;
  Order order = Order::placed;
  Radii radii = Radii::uniform;
  double size = 1.0;             // edge of the cloud; integer layouts have their own
  double offset = 0.0;           // of the cloud from the origin, along every axis
  double thickness = 1.0;        // factor on all radii
  bool larger_id_first = false;  // the rule for equal distances; otherwise the smaller id is shown
  std::uint64_t seed = 0;
};
std::ostream& operator<<(std::ostream& out, const TreeCase& c);

// Coordinates x y z x y z ... of a cloud with that edge length around the origin.
std::vector<double> make_cloud(Shape shape, std::uint64_t count, double size, CounterRandom& random);

class TestTree {
 public:
  // Call within the threads that the build is to use.
  explicit TestTree(const TreeCase& description);
  TestTree(const TestTree&) = delete;
  TestTree& operator=(const TestTree&) = delete;

  const kernels::PkdTree& tree() const { return tree_; }
  std::uint64_t count() const { return tree_.count; }
  // Who stands at a place: the number of the particle in the cloud that the case describes.
  std::uint64_t original(std::uint64_t place) const;
  // Coordinates as the layout holds them, of particle `original`.
  const double* given(std::uint64_t original) const { return &given_[3 * original]; }
  double given_radius(std::uint64_t original) const { return given_radius_[original]; }
  double size() const { return size_; }

 private:
  void lay_out(const TreeCase& description);
  void set_radii(const TreeCase& description);
  void put_in_order(Order order);

  kernels::PkdTree tree_;
  double size_ = 0.0;
  std::vector<double> given_;
  std::vector<double> given_radius_;
  // Every array has exactly the bytes it needs, so that AddressSanitizer sees a read behind its end.
  std::vector<std::unique_ptr<std::byte[]>> memory_;
  std::vector<MovedColumn> columns_;
  std::vector<std::uint32_t> index32_;
  std::vector<std::uint64_t> index64_;
  std::vector<std::uint32_t> who_;  // moves along with what is permuted
  std::vector<double> type_radius_;
};

}  // namespace insitu::testing
