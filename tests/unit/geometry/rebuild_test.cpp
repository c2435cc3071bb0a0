// Rebuilding from the order of the last step: whatever the particles did, the tree obeys the same rules, every record
// is whole, and the hits are those of a tree from scratch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "core/budget.h"
#include "core/workers.h"
#include "geometry/particles/particles.h"
#include "kernels/pkd_reference.h"
#include "kernels/pkd_traverse.h"
#include "unit/geometry/arrays.h"
#include "unit/kernels/test_tree.h"

namespace insitu::testing {
namespace {

using How = PkdBuilt::How;

enum class Memory { records_f32, records_f64, strided_f32, columns_f64, rows_f32, records_i32 };

// A simulation: particles with numbers and a payload that names them, in one of the layouts.
class Host {
 public:
  Host(Memory memory, const std::vector<double>& x) : memory_(memory), count_(x.size() / 3) {
    const std::size_t n = 3 * count_;
    switch (memory_) {
      case Memory::records_f64:
      case Memory::columns_f64:
        f64_.resize(n);
        break;
      case Memory::records_i32:
        i32_.resize(n);
        break;
      case Memory::strided_f32:
        f32_.resize(5 * count_);
        break;
      default:
        f32_.resize(n);
    }
    for (std::size_t i = 0; i < count_; ++i) {
      table_.push_back(memory_ == Memory::rows_f32 ? &f32_[3 * i] : nullptr);
      id_.push_back(i);
      name_.push_back(stir(i));
      for (std::uint32_t c = 0; c < 3; ++c) set(i, c, x[3 * i + c]);
    }
  }
  std::uint64_t count() const { return count_; }
  std::uint64_t id(std::uint64_t place) const { return id_[place]; }
  static std::uint32_t stir(std::uint64_t i) { return static_cast<std::uint32_t>(i * 2654435761u ^ i >> 3); }

  double get(std::uint64_t place, std::uint32_t c) const {
    if (memory_ == Memory::records_i32) return i32_[3 * place + c] / lattice;
    if (memory_ == Memory::records_f64) return f64_[3 * place + c];
    if (memory_ == Memory::columns_f64) return f64_[c * count_ + place];
    return static_cast<double>(f32_[(memory_ == Memory::strided_f32 ? 5 : 3) * place + c]);
  }
  void set(std::uint64_t place, std::uint32_t c, double value) {
    if (memory_ == Memory::records_i32) {
      i32_[3 * place + c] = static_cast<std::int32_t>(std::lround(value * lattice));
    } else if (memory_ == Memory::records_f64) {
      f64_[3 * place + c] = value;
    } else if (memory_ == Memory::columns_f64) {
      f64_[c * count_ + place] = value;
    } else {
      f32_[(memory_ == Memory::strided_f32 ? 5 : 3) * place + c] = static_cast<float>(value);
    }
  }
  std::array<double, 3> centre(std::uint64_t place) const { return {get(place, 0), get(place, 1), get(place, 2)}; }

  ParticleArrays arrays() {
    ParticleArrays a;
    insitu_array position{};
    switch (memory_) {
      case Memory::records_f64:
        position = insitu_array_records(INSITU_F64, 3, f64_.data(), count_, 0);
        break;
      case Memory::columns_f64:
        position =
            insitu_array_columns(INSITU_F64, f64_.data(), f64_.data() + count_, f64_.data() + 2 * count_, count_);
        break;
      case Memory::records_i32:
        position = insitu_array_records(INSITU_I32, 3, i32_.data(), count_, 0);
        a.position_scale = 1.0 / lattice;
        break;
      case Memory::strided_f32:
        position = insitu_array_records(INSITU_F32, 3, f32_.data(), count_, 20);
        break;
      case Memory::rows_f32:
        position = insitu_array_records(INSITU_F32, 3, table_.data(), count_, 0);
        position.flags = INSITU_ARRAY_ROWS;
        break;
      default:
        position = insitu_array_records(INSITU_F32, 3, f32_.data(), count_, 0);
    }
    a.position = checked_view(position, INSITU_USE_POSITION, "position");
    a.attributes.push_back({"id", attribute_of(id_)});
    a.payload.push_back(attribute_of(name_));
    a.radius_default = 0.5 / std::cbrt(static_cast<double>(std::max<std::uint64_t>(count_, 1)));
    return a;
  }

  // Positions by number, for comparison after the records have moved.
  std::vector<std::array<double, 3>> by_id() const {
    std::vector<std::array<double, 3>> all(count_);
    for (std::uint64_t i = 0; i < count_; ++i) all[id_[i]] = centre(i);
    return all;
  }
  void expect_whole(const std::vector<std::array<double, 3>>& given) const {
    std::vector<bool> seen(count_, false);
    for (std::uint64_t i = 0; i < count_; ++i) {
      ASSERT_LT(id_[i], count_);
      ASSERT_FALSE(seen[id_[i]]);
      seen[id_[i]] = true;
      ASSERT_EQ(name_[i], stir(id_[i]));
      ASSERT_EQ(centre(i), given[id_[i]]);
    }
  }

 private:
  static constexpr double lattice = 1 << 24;
  Memory memory_;
  std::uint64_t count_;
  std::vector<float> f32_;
  std::vector<double> f64_;
  std::vector<std::int32_t> i32_;
  std::vector<float*> table_;
  std::vector<std::uint64_t> id_;
  std::vector<std::uint32_t> name_;
};

std::vector<double> unit_cloud(Shape shape, std::uint64_t count, std::uint64_t seed) {
  CounterRandom random(seed);
  return make_cloud(shape, count, 1.0, random);
}

// By `amount` of the mean spacing; into the periodic cube [-0.5, 0.5].
void displace(Host& host, double amount, CounterRandom& random) {
  const double reach = amount / std::cbrt(static_cast<double>(host.count()));
  for (std::uint64_t i = 0; i < host.count(); ++i)
    for (std::uint32_t c = 0; c < 3; ++c) {
      const double x = host.get(i, c) + reach * random.between(-1.0, 1.0);
      host.set(i, c, x - std::floor(x + 0.5));
    }
}

// What rays see: distance, and the number of the particle.
std::vector<std::pair<double, double>> picture_of(const Particles& particles) {
  CounterRandom random(77);
  std::vector<kernels::Ray> rays(400);
  for (kernels::Ray& ray : rays) {
    random.direction(ray.direction);
    for (int c = 0; c < 3; ++c) ray.origin[c] = random.between(-0.5, 0.5) - 2.0 * ray.direction[c];
  }
  std::vector<kernels::Hit> hits(rays.size());
  particles.first_hits(rays.data(), hits.data(), rays.size());
  std::vector<std::pair<double, double>> seen;
  for (const kernels::Hit& hit : hits)
    seen.emplace_back(hit.t, hit.found() ? particles.attribute("id")->value(hit.item) : -1.0);
  return seen;
}

struct Case {
  ParticleOrder order;
  Memory memory;
};

class Rebuild : public ::testing::TestWithParam<Case> {
 protected:
  // Builds, moves, builds again; returns how, after all checks.
  PkdBuilt step(Particles& particles, Host& host, const char* what) {
    const std::vector<std::array<double, 3>> given = host.by_id();
    particles.bind(host.arrays());
    particles.build(budget_);
    const PkdBuilt how = particles.how_built();
    EXPECT_EQ(kernels::find_broken_invariant(particles.tree()), kernels::no_item) << what;
    host.expect_whole(given);
    if (GetParam().order != ParticleOrder::permute) {
      std::vector<std::uint64_t> listed(host.count());
      particles.permutation(listed.data(), listed.size());
      std::sort(listed.begin(), listed.end());
      std::vector<std::uint64_t> all(host.count());
      std::iota(all.begin(), all.end(), std::uint64_t{0});
      EXPECT_EQ(listed, all) << what;
    }
    Particles scratch("scratch", ParticleOrder::index, false);
    Budget budget(0);
    scratch.bind(host.arrays());
    scratch.build(budget);
    EXPECT_EQ(picture_of(particles), picture_of(scratch)) << what;
    return how;
  }
  Budget budget_{0};
};

TEST_P(Rebuild, AfterEveryDisplacement) {
  std::uint64_t seed = 0;
  for (const Shape shape : {Shape::uniform, Shape::clustered, Shape::planar, Shape::grid, Shape::coincident_groups})
    for (const std::uint64_t count : {3000u, 140000u}) {
      // More than one thread mends at a time: for a layout of every kind.
      const bool is_short = GetParam().memory == Memory::records_f32 || GetParam().memory == Memory::columns_f64;
      if (count > 10000 && (!is_short || shape != Shape::uniform)) continue;
      Host host(GetParam().memory, unit_cloud(shape, count, ++seed));
      Particles particles("particles", GetParam().order, false);
      EXPECT_EQ(step(particles, host, "first").how, How::built);
      CounterRandom random(seed);
      for (const double amount : {0.0, 0.001, 0.01, 0.1, 1.0}) {
        displace(host, amount, random);
        const auto what =
            std::string(name_of(shape)) + ", " + std::to_string(count) + ", displaced by " + std::to_string(amount);
        const PkdBuilt how = step(particles, host, what.c_str());
        if (shape != Shape::uniform) continue;
        if (amount == 0.0) {
          EXPECT_EQ(how.how, How::reused) << what;
          EXPECT_EQ(how.moved, 0u) << what;
        } else if (amount < 0.1) {
          // So little may leave all on their sides.
          EXPECT_TRUE(how.how == How::repaired || (amount < 0.01 && how.how == How::reused)) << what;
          EXPECT_LT(how.moved, count / 4) << what;
        }
      }
    }
}

// Another number of particles, other radii, some that cannot be drawn, some that jump, a box that grows.
TEST_P(Rebuild, AfterChangesOfAnotherKind) {
  Particles particles("particles", GetParam().order, false);
  for (const std::uint64_t count : {4000u, 3500u, 4000u, 0u, 1u, 4000u}) {
    Host host(GetParam().memory, unit_cloud(Shape::uniform, count, 1));
    step(particles, host, "another count");
  }
  Host host(GetParam().memory, unit_cloud(Shape::uniform, 4000, 1));
  CounterRandom random(5);
  for (int turn = 0; turn < 12; ++turn) {
    for (int jump = 0; jump < (turn % 3 == 0 ? 1 : 300); ++jump) {
      const std::uint64_t who = random.below(host.count());
      for (std::uint32_t c = 0; c < 3; ++c) host.set(who, c, random.between(-0.5, 0.5));
    }
    if (turn == 6)
      for (std::uint64_t i = 0; i < host.count(); ++i) host.set(i, 1, 1.5 * host.get(i, 1));
    step(particles, host, "jumps");
  }
  const std::vector<std::array<double, 3>> given = host.by_id();
  ParticleArrays arrays = host.arrays();
  std::vector<float> radius(host.count(), 0.02f);
  for (std::size_t i = 0; i < radius.size(); i += 9) radius[i] = i % 2 == 0 ? 0.0f : 0.05f;
  arrays.radius = view_of(radius, 1, INSITU_USE_RADIUS);
  particles.bind(std::move(arrays));
  particles.build(budget_);
  EXPECT_EQ(particles.drawn_count(), host.count() - (radius.size() / 9 + 2) / 2);
  EXPECT_EQ(kernels::find_broken_invariant(particles.tree()), kernels::no_item);
  host.expect_whole(given);
  step(particles, host, "all of them again");
}

// A repair does the same with any number of threads.
TEST(RebuildThreads, DoNotShow) {
  std::vector<std::vector<std::uint64_t>> orders;
  for (const unsigned threads : {1u, 2u, 8u}) {
    Workers workers(threads);
    Host host(Memory::records_f32, unit_cloud(Shape::uniform, 200000, 9));
    Particles particles("particles", ParticleOrder::permute, false);
    Budget budget(0);
    CounterRandom random(10);
    for (int step = 0; step < 3; ++step) {
      particles.bind(host.arrays());
      workers.run([&] { particles.build(budget); });
      EXPECT_EQ(particles.how_built().how, step == 0 ? How::built : How::repaired);
      if (step < 2) displace(host, 0.02, random);
    }
    EXPECT_EQ(kernels::find_broken_invariant(particles.tree()), kernels::no_item);
    orders.emplace_back();
    for (std::uint64_t i = 0; i < host.count(); ++i) orders.back().push_back(host.id(i));
    EXPECT_EQ(orders.back(), orders.front()) << threads;
    EXPECT_EQ(budget.owned(), 0u);
  }
}

std::string name_of(const Case& c) {
  constexpr const char* orders[] = {"index", "permute", "copy"};
  constexpr const char* memories[] = {"records_f32", "records_f64", "strided_f32",
                                      "columns_f64", "rows_f32",    "records_i32"};
  return std::string(orders[static_cast<int>(c.order)]) + "_" + memories[static_cast<int>(c.memory)];
}

constexpr Case cases[] = {{ParticleOrder::permute, Memory::records_f32}, {ParticleOrder::permute, Memory::records_f64},
                          {ParticleOrder::permute, Memory::strided_f32}, {ParticleOrder::permute, Memory::columns_f64},
                          {ParticleOrder::permute, Memory::rows_f32},    {ParticleOrder::permute, Memory::records_i32},
                          {ParticleOrder::index, Memory::records_f32},   {ParticleOrder::index, Memory::columns_f64},
                          {ParticleOrder::index, Memory::records_i32},   {ParticleOrder::copy, Memory::records_f32},
                          {ParticleOrder::copy, Memory::rows_f32}};

INSTANTIATE_TEST_SUITE_P(Cases, Rebuild, ::testing::ValuesIn(cases),
                         [](const auto& info) { return name_of(info.param); });

}  // namespace
}  // namespace insitu::testing
