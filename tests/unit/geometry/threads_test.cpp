// The tree is the same for any number of threads, and so is all that is computed in parallel over the arrays.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/budget.h"
#include "core/workers.h"
#include "geometry/particles/particles.h"
#include "kernels/pkd_reference.h"
#include "unit/kernels/test_tree.h"

namespace insitu::testing {
namespace {

// Above two blocks of the build, and two chunks of its exchange, so that several threads take part.
constexpr std::uint64_t count = 150000;

std::vector<std::uint64_t> order_of(const TreeCase& c, unsigned threads) {
  Workers workers(threads);
  std::vector<std::uint64_t> order;
  workers.run([&] {
    const TestTree built(c);
    EXPECT_EQ(kernels::find_broken_invariant(built.tree()), kernels::no_item) << c;
    for (std::uint64_t place = 0; place < built.count(); ++place) order.push_back(built.original(place));
  });
  return order;
}

class EveryOrder : public ::testing::TestWithParam<Order> {};

TEST_P(EveryOrder, IsTheSameForAnyNumberOfThreads) {
  std::uint64_t seed = 0;
  for (const Shape shape : {Shape::uniform, Shape::clustered, Shape::grid, Shape::coincident_groups}) {
    TreeCase c;
    c.count = count;
    c.shape = shape;
    c.layout = seed % 2 == 0 ? Layout::columns_f64 : Layout::strided_f32;
    c.order = GetParam();
    c.radii = all_radii[seed % 3];
    c.seed = ++seed;
    const std::vector<std::uint64_t> one = order_of(c, 1);
    EXPECT_EQ(order_of(c, 2), one) << c;
    EXPECT_EQ(order_of(c, 8), one) << c;
    EXPECT_EQ(order_of(c, 8), one) << c;
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, EveryOrder, ::testing::ValuesIn(all_orders),
                         [](const auto& info) { return std::string(name_of(info.param)); });

struct Summary {
  std::uint64_t drawn;
  std::uint64_t checksum;
  double lower[3];
  double upper[3];
  ValueRange range;
};

Summary summary_of(const std::vector<double>& x, const std::vector<double>& values, unsigned threads) {
  Workers workers(threads);
  return workers.run([&] {
    const auto view = [](const std::vector<double>& v, std::uint32_t components) {
      kernels::ArrayView result;
      result.type = kernels::Scalar::f64;
      result.components = components;
      result.count = v.size() / components;
      result.stride = static_cast<std::ptrdiff_t>(components * sizeof(double));
      for (std::uint32_t c = 0; c < components; ++c) result.base[c] = reinterpret_cast<const std::byte*>(&v[c]);
      return result;
    };
    ParticleArrays arrays;
    arrays.position = view(x, 3);
    arrays.attributes.push_back({"value", view(values, 1)});
    arrays.radius_default = 0.01;
    Particles particles("particles", ParticleOrder::index, false);
    particles.bind(std::move(arrays));
    Budget budget(0);
    particles.build(budget);
    Summary summary{};
    summary.drawn = particles.drawn_count();
    summary.checksum = particles.checksum();
    particles.bounds(summary.lower, summary.upper);
    summary.range = value_range(*particles.attribute("value"), 0);
    EXPECT_EQ(particles.describe_bad_values().size(), 1u);
    return summary;
  });
}

TEST(Threads, SumsAndRangesAreTheSame) {
  CounterRandom random(3);
  std::vector<double> x = make_cloud(Shape::uniform, count, 1.0, random);
  x[300] = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values(count);
  for (double& v : values) v = random.between(-3.0, 5.0);
  values[5] = std::numeric_limits<double>::infinity();
  const Summary one = summary_of(x, values, 1);
  EXPECT_EQ(one.drawn, count - 1);
  for (const unsigned threads : {2u, 8u}) {
    const Summary other = summary_of(x, values, threads);
    EXPECT_EQ(other.drawn, one.drawn);
    EXPECT_EQ(other.checksum, one.checksum);
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(other.lower[c], one.lower[c]);
      EXPECT_EQ(other.upper[c], one.upper[c]);
    }
    EXPECT_EQ(other.range.low, one.range.low);
    EXPECT_EQ(other.range.high, one.range.high);
  }
}

}  // namespace
}  // namespace insitu::testing
