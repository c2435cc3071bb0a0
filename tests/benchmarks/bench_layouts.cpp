// What the layout of a host's positions costs: a frame of the same particles, camera rays and an occlusion ray from
// every hit, over arrays as different codes have them, beside packed f32 records in the same order of the particles.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>

#include "geometry/particles/particles.h"
#include "measure.h"
#include "particle_scenes.h"
#include "ray_tiles.h"

namespace {

using insitu::ParticleOrder;
using insitu::kernels::ArrayView;
using insitu::kernels::Hit;
using insitu::kernels::Ray;
using insitu::kernels::Scalar;

struct Options {
  bool quick = false;
  std::string json;
  std::vector<std::string> scenes = {"uniform", "clustered"};
  std::uint64_t particles = 1000000;
  std::uint32_t edge_px = 512;
  unsigned threads = 1;
  int repetitions = 5;
};

struct Layout {
  const char* name;
  Scalar type;
  std::size_t record_bytes;  // from particle to particle; 0: three columns
  bool rows = false;         // through a table of pointers to records
};

constexpr Layout layouts[] = {{"f32_records", Scalar::f32, 12},
                              {"f32_columns", Scalar::f32, 0},
                              {"f32_in_structs_of_32", Scalar::f32, 32},
                              {"f64_records", Scalar::f64, 24},
                              {"f64_columns", Scalar::f64, 0},
                              {"f64_in_structs_of_64", Scalar::f64, 64},
                              {"f64_scattered_rows", Scalar::f64, 24, true},
                              {"i32_lattice", Scalar::i32, 12}};
constexpr double lattice_scale = 1.0 / (1 << 20);

void store(Scalar type, std::byte* to, float value) {
  if (type == Scalar::f32) std::memcpy(to, &value, sizeof value);
  if (type == Scalar::f64) {
    const double wide = static_cast<double>(value);
    std::memcpy(to, &wide, sizeof wide);
  }
  if (type == Scalar::i32) {
    const auto whole = static_cast<std::int32_t>(static_cast<double>(value) / lattice_scale);
    std::memcpy(to, &whole, sizeof whole);
  }
}

// A set over positions in one layout.
class LaidOut {
 public:
  LaidOut(const bench::ParticleScene& scene, const Layout& layout, ParticleOrder order, double treelet_share)
      : particles_("particles", order, false) {
    const std::uint64_t count = scene.count();
    const std::size_t size = insitu::kernels::size_of(layout.type);
    const std::size_t record = layout.record_bytes == 0 ? size : layout.record_bytes;
    const std::size_t next = layout.record_bytes == 0 ? size * count : size;  // from component to component
    memory_.resize(std::max(record * count, next * 2 + record * count));
    ArrayView view;
    view.type = layout.type;
    view.components = 3;
    view.count = count;
    view.stride = static_cast<std::ptrdiff_t>(record);
    for (std::uint32_t c = 0; c < 3; ++c) {
      view.base[c] = memory_.data() + c * next;
      for (std::uint64_t i = 0; i < count; ++i)
        store(layout.type, memory_.data() + c * next + i * record, scene.position[3 * i + c]);
    }
    if (layout.rows) {
      for (std::uint64_t i = 0; i < count; ++i) table_.push_back(memory_.data() + i * record);
      view.rows = true;
      view.stride = sizeof(std::byte*);
      view.base[0] = reinterpret_cast<const std::byte*>(table_.data());
    }
    insitu::ParticleArrays arrays;
    arrays.position = view;
    if (layout.type == Scalar::i32) arrays.position_scale = lattice_scale;
    arrays.radius_default = scene.radius;
    arrays.treelet_share = treelet_share;
    particles_.bind(arrays);
    particles_.build(budget_);
  }
  const insitu::Particles& set() const { return particles_; }

  std::vector<Ray> ao;  // those of the first layout, which know the particles by the numbers of this one

 private:
  std::vector<std::byte> memory_;
  std::vector<std::byte*> table_;
  insitu::Budget budget_{0};
  insitu::Particles particles_;
};

struct Frames {
  const Options& options;
  insitu::Workers& workers;
  bench::Report& report;
};

std::vector<Hit> trace_camera(const LaidOut& own, const std::vector<Ray>& camera) {
  std::vector<Hit> hits(camera.size());
  own.set().first_hits(camera.data(), hits.data(), camera.size());
  return hits;
}

void measure(Frames& to, const bench::ParticleScene& scene, const std::string& view, const char* order_name,
             ParticleOrder order, double treelet_share) {
  const std::vector<Ray> camera = bench::camera_rays(view, to.options.edge_px);
  std::vector<std::unique_ptr<LaidOut>> owns;
  std::vector<const Layout*> measured;
  std::vector<Hit> first_hits;
  for (const Layout& layout : layouts) {
    if (layout.rows && order == ParticleOrder::permute) continue;  // only records can be moved
    measured.push_back(&layout);
    to.workers.run([&] { owns.push_back(std::make_unique<LaidOut>(scene, layout, order, treelet_share)); });
    const std::vector<Hit> hits = trace_camera(*owns.back(), camera);
    if (owns.size() == 1) {
      first_hits = hits;
      std::vector<float> centres(3 * scene.count());
      for (std::uint64_t i = 0; i < scene.count(); ++i) {
        double centre[3];
        owns.front()->set().centre(i, centre);
        for (std::size_t c = 0; c < 3; ++c) centres[3 * i + c] = static_cast<float>(centre[c]);
      }
      owns.front()->ao = bench::occlusion_rays(camera, hits, centres, 1e30);
      continue;
    }
    owns.back()->ao = owns.front()->ao;
    for (std::size_t i = 0, next = 0; i < camera.size(); ++i)
      if (first_hits[i].found()) owns.back()->ao[next++].exclude = hits[i].item;
  }
  std::vector<Hit> hits(camera.size());
  std::vector<std::uint8_t> occluded(owns.front()->ao.size());
  std::vector<bench::Contender> contenders;
  for (std::size_t k = 0; k < owns.size(); ++k) {
    const LaidOut& own = *owns[k];
    contenders.push_back({measured[k]->name,
                          [&] {
                            std::fill(hits.begin(), hits.end(), Hit{});
                            std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
                          },
                          [&] {
                            to.workers.run([&] {
                              bench::for_tiles(camera.size(), [&](std::size_t begin, std::size_t n) {
                                own.set().first_hits(&camera[begin], &hits[begin], n);
                              });
                              bench::for_tiles(own.ao.size(), [&](std::size_t begin, std::size_t n) {
                                own.set().any_hits(&own.ao[begin], &occluded[begin], n);
                              });
                            });
                          }});
  }
  const std::vector<double> seconds = bench::take_turns(contenders, to.options.repetitions);
  for (std::size_t k = 0; k < owns.size(); ++k) {
    const double speed = seconds[0] / seconds[k];
    std::printf("| %s | %s | %s | %s | %.1f | %.2f |\n", scene.name.c_str(), view.c_str(), order_name,
                measured[k]->name, 1e3 * seconds[k], speed);
    to.report.context()["rows"].push_back({{"scene", scene.name},
                                           {"view", view},
                                           {"order", order_name},
                                           {"layout", measured[k]->name},
                                           {"seconds", seconds[k]}});
    auto& worst = to.report.results()[std::string("layout_speed.") + order_name + "." + measured[k]->name];
    worst = worst.is_null() ? speed : std::min(worst.get<double>(), speed);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Frames of particles over arrays in the layouts that codes have");
  Options options;
  app.add_flag("--quick", options.quick, "one scene, 3 repetitions: within 45 s");
  app.add_option("--json", options.json, "write {context, results} to this file");
  app.add_option("--particles", options.particles)->capture_default_str();
  app.add_option("--edge", options.edge_px, "pixels, a multiple of 64")->capture_default_str();
  app.add_option("--scenes", options.scenes, "uniform, clustered")->capture_default_str();
  app.add_option("--threads", options.threads)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (options.quick) {
    options.repetitions = 3;
    options.scenes = {"clustered"};
    options.edge_px = 256;
  }
  bench::Report report(argc, argv);
  report.context()["particles"] = options.particles;
  report.context()["edge_px"] = options.edge_px;
  report.context()["threads"] = options.threads;
  insitu::Workers workers(options.threads);
  Frames frames{options, workers, report};
  std::printf("| particles | view | order | layout | ms | over f32 records |\n|---|---|---|---|---|---|\n");
  for (const std::string& name : options.scenes) {
    const bench::ParticleScene scene = bench::make_scene(name, options.particles);
    for (const char* view : {"far", "close"}) {
      measure(frames, scene, view, "permute", ParticleOrder::permute, 0.0);
      measure(frames, scene, view, "permute_treelets", ParticleOrder::permute, 0.15);
      measure(frames, scene, view, "index", ParticleOrder::index, 0.0);
      measure(frames, scene, view, "index_treelets", ParticleOrder::index, 0.15);
    }
  }
  if (!report.write(options.json)) {
    std::fprintf(stderr, "%s could not be written\n", options.json.c_str());
    return 1;
  }
}
