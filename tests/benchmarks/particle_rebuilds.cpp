#include "particle_rebuilds.h"

#include <cmath>
#include <cstdio>
#include <memory>

#include "geometry/particles/particles.h"
#include "geometry/pkd/pkd_build.h"
#include "md/simulation.h"
#include "measure.h"
#include "renderer/sampling.h"

namespace bench {
namespace {

using insitu::ParticleOrder;
using insitu::kernels::ArrayView;

double noise(std::uint64_t i, std::uint32_t purpose) {
  return insitu::pixel_noise(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i >> 32), purpose, 2015).x;
}

template <class Record>
void shuffle(std::vector<Record>& records) {
  for (std::size_t i = records.size(); i > 1; --i)
    std::swap(records[i - 1], records[static_cast<std::size_t>(noise(i, 31) * static_cast<double>(i))]);
}

// A set of particles over records of the caller's, which are put back into a given order before each build.
template <class Record>
class Contestant {
 public:
  using Arrays = insitu::ParticleArrays (*)(std::vector<Record>& records);

  Contestant(const std::vector<Record>& given, Arrays arrays, ParticleOrder order)
      : given_(given), records_(given), arrays_(arrays), particles_("particles", order, false) {}

  void prepare() {
    records_ = given_;
    particles_.bind(arrays_(records_));
  }
  // As a simulation does it from step to step: the set has been built before.
  void prepare_after(const std::vector<Record>& before) {
    records_ = before;
    particles_.bind(arrays_(records_));
    particles_.build(budget_);
    prepare();
  }
  void build() { particles_.build(budget_); }
  // The same tree without looking whether the particles are nearly in order. Only once it has been built.
  void build_anyway() {
    insitu::build_columns(particles_.tree(),
                          {{reinterpret_cast<std::byte*>(records_.data()), sizeof(Record), sizeof(Record), false}},
                          insitu::Repair::never);
  }
  const insitu::PkdBuilt& how() const { return particles_.how_built(); }
  std::vector<Record>& records() { return records_; }

 private:
  std::vector<Record> given_;
  std::vector<Record> records_;
  Arrays arrays_;
  insitu::Budget budget_{0};
  insitu::Particles particles_;
};

struct Point {
  float x[3];
};

ArrayView view_of(const void* first, std::uint64_t count, std::size_t stride, std::uint32_t components,
                  insitu::kernels::Scalar type) {
  ArrayView view;
  view.type = type;
  view.components = components;
  view.count = count;
  view.stride = static_cast<std::ptrdiff_t>(stride);
  for (std::uint32_t c = 0; c < components; ++c)
    view.base[c] = static_cast<const std::byte*>(first) + c * insitu::kernels::size_of(type);
  return view;
}

insitu::ParticleArrays arrays_of_points(std::vector<Point>& points) {
  insitu::ParticleArrays arrays;
  arrays.position = view_of(points.data(), points.size(), sizeof(Point), 3, insitu::kernels::Scalar::f32);
  arrays.radius_default = 0.001;
  return arrays;
}

// As mini-apps/melt/picture.cpp hands them over.
insitu::ParticleArrays arrays_of_atoms(std::vector<melt::Particle>& atoms) {
  const auto column = [&](const void* first, std::uint32_t components, insitu::kernels::Scalar type) {
    return view_of(first, atoms.size(), sizeof(melt::Particle), components, type);
  };
  insitu::ParticleArrays arrays;
  arrays.position = column(&atoms[0].position, 3, insitu::kernels::Scalar::f64);
  arrays.attributes.push_back({"velocity", column(&atoms[0].velocity, 3, insitu::kernels::Scalar::f64)});
  arrays.payload.push_back(column(&atoms[0].force, 3, insitu::kernels::Scalar::f64));
  arrays.payload.push_back(column(&atoms[0].id, 1, insitu::kernels::Scalar::i64));
  arrays.radius_default = 0.5;
  return arrays;
}

template <class Record>
std::map<std::string, double> measure(const char* name, const BuildOptions& options, const std::vector<Record>& before,
                                      const std::vector<Record>& ordered, typename Contestant<Record>::Arrays arrays,
                                      insitu::Workers& workers, nlohmann::ordered_json& rows) {
  std::vector<Record> random = ordered;
  shuffle(random);
  Contestant<Record> rebuilt(ordered, arrays, ParticleOrder::permute);
  Contestant<Record> scratch(random, arrays, ParticleOrder::permute);
  Contestant<Record> anyway(ordered, arrays, ParticleOrder::permute);
  const std::vector<double> s =
      take_turns({{"rebuild", [&] { rebuilt.prepare_after(before); }, [&] { workers.run([&] { rebuilt.build(); }); }},
                  {"random order", [&] { scratch.prepare(); }, [&] { workers.run([&] { scratch.build(); }); }},
                  {"last order, not repaired",
                   [&] {
                     anyway.prepare();
                     workers.run([&] { anyway.build(); });
                     anyway.records() = ordered;
                   },
                   [&] { workers.run([&] { anyway.build_anyway(); }); }}},
                 options.repetitions);
  const auto million = static_cast<double>(ordered.size()) / 1e6;
  const char* how[] = {"built", "repaired", "reused"};
  std::printf(
      "%-9s %4.1fM rebuild, million particles/s: %.2f (%s, %.1f %% moved)  random order %.2f  last order, not repaired "
      "%.2f | %.2f times as fast as from random order, %.2f from the last one\n",
      name, million, million / s[0], how[static_cast<int>(rebuilt.how().how)],
      100.0 * static_cast<double>(rebuilt.how().moved) / static_cast<double>(ordered.size()), million / s[1],
      million / s[2], s[1] / s[0], s[2] / s[0]);
  rows.push_back({{"scene", name},
                  {"particles", ordered.size()},
                  {"seconds", {{"rebuild", s[0]}, {"random order", s[1]}, {"last order, not repaired", s[2]}}},
                  {"moved", rebuilt.how().moved}});
  return {{"rebuild_speedup", s[1] / s[0]},
          {"rebuild_speedup_vs_last_order", s[2] / s[0]},
          {std::string("rebuild_speedup_") + name, s[1] / s[0]}};
}

}  // namespace

std::map<std::string, double> measure_displaced_rebuild(const BuildOptions& options, const ParticleScene& scene,
                                                        insitu::Workers& workers, nlohmann::ordered_json& rows) {
  std::vector<Point> points(scene.count());
  std::memcpy(points.data(), scene.position.data(), points.size() * sizeof(Point));
  Contestant<Point> last(points, arrays_of_points, ParticleOrder::permute);
  last.prepare();
  workers.run([&] { last.build(); });
  const std::vector<Point> before = last.records();
  points = before;
  const double reach = 0.01 / std::cbrt(static_cast<double>(scene.count()));
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::uint32_t c = 0; c < 3; ++c) points[i].x[c] += static_cast<float>(reach * (2.0 * noise(i, 32 + c) - 1.0));
  return measure("displaced", options, before, points, arrays_of_points, workers, rows);
}

std::map<std::string, double> measure_melt_rebuild(const BuildOptions& options, insitu::Workers& workers,
                                                   nlohmann::ordered_json& rows) {
  melt::SimulationDesc desc;  // as the mini-app has it by default, but for the size
  desc.atoms = options.quick ? 108000 : 500000;
  desc.threads = 2;
  constexpr int every = 50;  // steps from picture to picture, as melt draws them by default
  melt::Simulation simulation(desc);
  for (int step = 0; step < (options.quick ? every : 4 * every); ++step)
    simulation.step_with_thermostat(desc.temperature, 0.1);
  Contestant<melt::Particle> last({simulation.particles().begin(), simulation.particles().end()}, arrays_of_atoms,
                                  ParticleOrder::permute);
  last.prepare();
  workers.run([&] { last.build(); });
  std::copy(last.records().begin(), last.records().end(), simulation.particles().begin());
  simulation.records_moved();
  std::map<std::string, double> speeds;
  const auto rebuild = [&](const char* name) {
    return measure<melt::Particle>(name, options, last.records(),
                                   {simulation.particles().begin(), simulation.particles().end()}, arrays_of_atoms,
                                   workers, rows);
  };
  simulation.step();
  speeds = rebuild("melt");
  // From picture to picture a third of the atoms change their leaves: stated beside the bar, which is for a step.
  for (int step = 1; step < every; ++step) simulation.step();
  speeds["rebuild_speedup_melt_50_steps"] = rebuild("melt_50_steps").at("rebuild_speedup_melt_50_steps");
  return speeds;
}

}  // namespace bench
