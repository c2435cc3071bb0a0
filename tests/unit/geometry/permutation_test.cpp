// Permuting whole sets of arrays: records stay whole, byte for byte, whatever they are made of, and can be put back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>

#include "core/budget.h"
#include "core/error.h"
#include "geometry/particles/particles.h"
#include "kernels/pkd_reference.h"
#include "unit/geometry/arrays.h"
#include "unit/kernels/test_tree.h"

namespace insitu::testing {
namespace {

// Arrays as simulations have them: positions, a radius, a type, and payload of `payload_bytes` per particle.
struct Host {
  std::vector<double> x;
  std::vector<float> radius;
  std::vector<std::uint8_t> type;
  std::vector<std::uint64_t> id;
  std::vector<std::uint8_t> payload;
  std::uint32_t payload_bytes;

  Host(std::uint64_t count, std::uint32_t bytes, std::uint64_t seed) : payload_bytes(bytes) {
    CounterRandom random(seed);
    x = make_cloud(Shape::clustered, count, 1.0, random);
    for (std::uint64_t i = 0; i < count; ++i) {
      radius.push_back(static_cast<float>(random.between(0.001, 0.01)));
      type.push_back(static_cast<std::uint8_t>(random.below(3)));
      id.push_back(i);
      for (std::uint32_t b = 0; b < bytes; ++b) payload.push_back(static_cast<std::uint8_t>(random.next()));
    }
  }
  std::uint64_t count() const { return id.size(); }
  ParticleArrays arrays() const {
    ParticleArrays a;
    a.position = positions_of(x);
    a.radius = view_of(radius, 1, INSITU_USE_RADIUS);
    a.type = view_of(type, 1, INSITU_USE_TYPE);
    a.attributes.push_back({"id", attribute_of(id)});
    if (payload_bytes > 0) a.payload.push_back(view_of(payload, payload_bytes, use_payload));
    return a;
  }
};

// Every record of `now` is the record of `before` that its id names.
void expect_whole_records(const Host& now, const Host& before) {
  std::vector<bool> seen(now.count(), false);
  for (std::uint64_t place = 0; place < now.count(); ++place) {
    const std::uint64_t id = now.id[place];
    ASSERT_LT(id, now.count());
    ASSERT_FALSE(seen[id]);
    seen[id] = true;
    ASSERT_EQ(std::memcmp(&now.x[3 * place], &before.x[3 * id], 24), 0);
    ASSERT_EQ(now.radius[place], before.radius[id]);
    ASSERT_EQ(now.type[place], before.type[id]);
    const std::uint32_t bytes = now.payload_bytes;
    for (std::uint64_t b = 0; b < bytes; ++b) ASSERT_EQ(now.payload[bytes * place + b], before.payload[bytes * id + b]);
  }
}

TEST(Permute, MovesPayloadOfEverySize) {
  for (std::uint32_t bytes = 0; bytes <= 200; bytes += bytes < 10 || bytes > 60 ? 1 : 7) {
    Host host(150, bytes, bytes);
    const Host before = host;
    Particles particles("particles", ParticleOrder::permute, true);
    Budget budget(0);
    particles.bind(host.arrays());
    const std::uint64_t checksum = particles.checksum();
    particles.build(budget);
    EXPECT_EQ(kernels::find_broken_invariant(particles.tree()), kernels::no_item) << bytes;
    EXPECT_EQ(particles.checksum(), checksum) << bytes;
    EXPECT_NE(host.id, before.id) << bytes;
    expect_whole_records(host, before);
    std::vector<std::uint64_t> original(host.count());
    particles.permutation(original.data(), original.size());
    EXPECT_EQ(original, host.id) << bytes;
    particles.restore_order();
    EXPECT_EQ(host.x, before.x) << bytes;
    EXPECT_EQ(host.radius, before.radius) << bytes;
    EXPECT_EQ(host.type, before.type) << bytes;
    EXPECT_EQ(host.id, before.id) << bytes;
    EXPECT_EQ(host.payload, before.payload) << bytes;
    EXPECT_FALSE(particles.is_built());
  }
}

TEST(Permute, MovesManyParticles) {
  Host host(50000, 13, 1);
  const Host before = host;
  Particles particles("particles", ParticleOrder::permute, false);
  Budget budget(0);
  particles.bind(host.arrays());
  particles.build(budget);
  EXPECT_EQ(kernels::find_broken_invariant(particles.tree()), kernels::no_item);
  expect_whole_records(host, before);
  EXPECT_EQ(budget.owned(), 0u) << "permuting costs no memory per particle";
}

// Records of a struct, described by arrays of its fields and by one of its whole: each byte moves once.
TEST(Permute, MovesOverlappingDescriptionsOfARecord) {
  struct Record {
    double x[3];
    float mass;
    float radius;
    std::uint32_t id;
    std::uint8_t rest[20];
  };
  CounterRandom random(9);
  constexpr std::uint64_t count = 500;
  const std::vector<double> x = make_cloud(Shape::uniform, count, 1.0, random);
  std::vector<Record> records(count);
  std::memset(records.data(), 0, count * sizeof(Record));
  for (std::uint32_t i = 0; i < count; ++i) {
    std::copy_n(&x[3 * i], 3, records[i].x);
    records[i].mass = static_cast<float>(random.unit());
    records[i].radius = 0.01f;
    records[i].id = i;
    for (std::uint8_t& b : records[i].rest) b = static_cast<std::uint8_t>(random.next());
  }
  const std::vector<Record> before = records;
  constexpr std::int64_t stride = sizeof(Record);
  const auto field = [&](std::uint32_t type, std::uint32_t components, const void* first, std::uint32_t use) {
    return checked_view(insitu_array_records(type, components, first, count, stride), use, "field");
  };
  ParticleArrays arrays;
  arrays.position = field(INSITU_F64, 3, records[0].x, INSITU_USE_POSITION);
  arrays.radius = field(INSITU_F32, 1, &records[0].radius, INSITU_USE_RADIUS);
  arrays.attributes.push_back({"mass", field(INSITU_F32, 1, &records[0].mass, INSITU_USE_ATTRIBUTE)});
  arrays.attributes.push_back({"mass and radius", field(INSITU_F32, 2, &records[0].mass, INSITU_USE_ATTRIBUTE)});
  arrays.payload.push_back(field(INSITU_U8, sizeof(Record), records.data(), use_payload));
  Particles particles("particles", ParticleOrder::permute, false);
  Budget budget(0);
  particles.bind(std::move(arrays));
  particles.build(budget);
  std::vector<bool> seen(count, false);
  for (const Record& record : records) {
    ASSERT_FALSE(seen.at(record.id));
    seen[record.id] = true;
    EXPECT_EQ(std::memcmp(&record, &before[record.id], sizeof record), 0);
  }
}

// A table of row pointers stays as it is; what the rows hold moves.
TEST(Permute, MovesWhatRowsHold) {
  CounterRandom random(10);
  constexpr std::uint64_t count = 300;
  std::vector<double> data = make_cloud(Shape::uniform, count, 1.0, random);
  std::vector<double> before = data;
  std::vector<double*> table;
  for (std::uint64_t i = 0; i < count; ++i) table.push_back(&data[3 * (i * 7 % count)]);
  const std::vector<double*> table_before = table;
  insitu_array rows = insitu_array_records(INSITU_F64, 3, table.data(), count, 0);
  rows.flags = INSITU_ARRAY_ROWS;
  ParticleArrays arrays;
  arrays.position = checked_view(rows, INSITU_USE_POSITION, "rows");
  arrays.radius_default = 0.01;
  Particles particles("particles", ParticleOrder::permute, true);
  Budget budget(0);
  particles.bind(std::move(arrays));
  particles.build(budget);
  EXPECT_EQ(kernels::find_broken_invariant(particles.tree()), kernels::no_item);
  EXPECT_EQ(table, table_before);
  EXPECT_NE(data, before);
  particles.restore_order();
  EXPECT_EQ(data, before);
  EXPECT_EQ(table, table_before);
}

TEST(Permute, RefusesOverlapsAndTouchesNothing) {
  Host host(100, 0, 3);
  const Host before = host;
  ParticleArrays arrays = host.arrays();
  // The coordinates again, with a stride of one scalar.
  arrays.payload.push_back(attribute_of(host.x));
  Particles particles("particles", ParticleOrder::permute, false);
  EXPECT_THROW(particles.bind(std::move(arrays)), Error);
  EXPECT_FALSE(particles.is_bound());
  EXPECT_EQ(host.x, before.x);
}

class EveryPolicy : public ::testing::TestWithParam<ParticleOrder> {};

// Particles that cannot be drawn stand at the end, in every policy, and nothing else changes.
TEST_P(EveryPolicy, PutsSkippedParticlesAtTheEnd) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Host host(200, 5, 4);
  host.x[3 * 0] = nan;
  host.x[3 * 17 + 1] = infinity;
  host.x[3 * 99 + 2] = -infinity;
  host.x[3 * 100 + 2] = 1e101;
  host.radius[31] = 0.0f;
  host.radius[32] = -1.0f;
  host.radius[150] = std::numeric_limits<float>::quiet_NaN();
  host.radius[199] = std::numeric_limits<float>::infinity();
  std::vector<std::uint64_t> bad = {0, 17, 31, 32, 99, 100, 150, 199};
  const Host before = host;
  Particles particles("particles", GetParam(), true);
  Budget budget(0);
  particles.bind(host.arrays());
  particles.build(budget);
  EXPECT_EQ(particles.item_count(), 200u);
  EXPECT_EQ(particles.drawn_count(), 192u);
  EXPECT_EQ(kernels::find_broken_invariant(particles.tree()), kernels::no_item);
  std::vector<std::uint64_t> original(200);
  particles.permutation(original.data(), original.size());
  std::vector<std::uint64_t> tail(original.begin() + 192, original.end());
  std::sort(tail.begin(), tail.end());
  EXPECT_EQ(tail, bad);
  std::vector<std::uint64_t> sorted = original;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::uint64_t> all(200);
  std::iota(all.begin(), all.end(), std::uint64_t{0});
  EXPECT_EQ(sorted, all);
  if (GetParam() == ParticleOrder::permute) {
    EXPECT_EQ(original, host.id);
    for (std::uint64_t place = 0; place < 200; ++place)
      EXPECT_EQ(std::memcmp(&host.x[3 * place], &before.x[3 * host.id[place]], 24), 0);
  } else {
    EXPECT_EQ(host.id, before.id);
    EXPECT_EQ(std::memcmp(host.x.data(), before.x.data(), host.x.size() * 8), 0);
  }
}

TEST_P(EveryPolicy, TakesEmptyAndHopelessSets) {
  for (const std::uint64_t count : {0u, 1u, 50u}) {
    std::vector<double> x(3 * count, std::numeric_limits<double>::quiet_NaN());
    ParticleArrays arrays;
    arrays.position = positions_of(x);
    arrays.radius_default = 1.0;
    Particles particles("particles", GetParam(), false);
    Budget budget(0);
    particles.bind(std::move(arrays));
    particles.build(budget);
    EXPECT_EQ(particles.drawn_count(), 0u);
    double lower[3];
    double upper[3];
    particles.bounds(lower, upper);
    EXPECT_GT(lower[0], upper[0]);
    kernels::Ray ray{};
    ray.direction[2] = 1.0;
    kernels::Hit hit;
    particles.first_hits(&ray, &hit, 1);
    EXPECT_FALSE(hit.found());
    EXPECT_TRUE(particles.all_hits(ray).empty());
  }
}

TEST_P(EveryPolicy, CountsItsMemory) {
  Host host(1000, 0, 5);
  Budget budget(0);
  {
    Particles particles("particles", GetParam(), false);
    particles.bind(host.arrays());
    particles.build(budget);
    const std::uint64_t expected[] = {4000, 0, 4000 + 24000};
    EXPECT_EQ(budget.owned(), expected[static_cast<int>(GetParam())]);
    EXPECT_EQ(particles.copied_bytes(), GetParam() == ParticleOrder::copy ? 24000u : 0u);
    EXPECT_EQ(particles.borrowed_bytes(), 1000u * (24 + 4 + 1 + 8));
  }
  EXPECT_EQ(budget.owned(), 0u);
}

std::string name_of(ParticleOrder order) {
  return order == ParticleOrder::index ? "index" : order == ParticleOrder::permute ? "permute" : "copy";
}

INSTANTIATE_TEST_SUITE_P(Policies, EveryPolicy,
                         ::testing::Values(ParticleOrder::index, ParticleOrder::permute, ParticleOrder::copy),
                         [](const auto& info) { return name_of(info.param); });

TEST(Permute, NeedsConsentToRestore) {
  Host host(10, 0, 6);
  Budget budget(0);
  Particles unkept("unkept", ParticleOrder::permute, false);
  unkept.bind(host.arrays());
  std::vector<std::uint64_t> original(10);
  EXPECT_THROW(unkept.permutation(original.data(), 10), Error);
  unkept.build(budget);
  EXPECT_THROW(unkept.permutation(original.data(), 10), Error);
  EXPECT_THROW(unkept.restore_order(), Error);
  Particles index("index", ParticleOrder::index, true);
  index.bind(host.arrays());
  index.build(budget);
  EXPECT_THROW(index.restore_order(), Error);
  EXPECT_THROW(index.permutation(original.data(), 9), Error);
  index.permutation(original.data(), 10);
}

}  // namespace
}  // namespace insitu::testing
