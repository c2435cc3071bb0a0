// The P-k-d tree beside Embree: the same particles, rays and threads in one process, all taking turns.
//
// Two baselines. `_vs_embree_sphere` is SPHERE_POINT at its best: every build quality, single rays, packets of 8 and 16
// and streams, the best way for camera rays and the best for occlusion rays. `_vs_embree_best` adds user geometry with
// one sphere per primitive. A frame is one camera ray per pixel and one ambient occlusion ray per hit. Speeds are
// baseline seconds over ours; the metrics are the worst over scenes, sizes, views and numbers of threads.
#include <malloc.h>
#include <oneapi/tbb/parallel_for.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>

#include "core/workers.h"
#include "embree_spheres.h"
#include "geometry/particles/particles.h"
#include "kernels/pkd_traverse.h"
#include "measure.h"
#include "particle_builds.h"
#include "particle_rebuilds.h"

namespace {

using bench::EmbreeGeometry;
using bench::EmbreeRays;
using bench::EmbreeSpheres;
using bench::EmbreeTrace;
using bench::ParticleScene;
using insitu::ParticleOrder;
using insitu::kernels::Hit;
using insitu::kernels::Ray;

struct Options {
  bool quick = false;
  bool builds_only = false;
  std::string json;
  std::vector<std::uint64_t> counts;
  std::vector<std::string> scenes = {"uniform", "clustered"};
  int repetitions = 5;
  std::uint32_t image_edge_px = 1024;
  double ao_reach = 0.0;
};

// A set of particles of our own, with its arrays.
class OwnParticles {
 public:
  OwnParticles(const ParticleScene& scene, ParticleOrder order)
      : position(scene.position), particles_("particles", order, false) {
    insitu::ParticleArrays arrays;
    arrays.position.type = insitu::kernels::Scalar::f32;
    arrays.position.components = 3;
    arrays.position.count = scene.count();
    arrays.position.stride = 12;
    for (std::size_t c = 0; c < 3; ++c)
      arrays.position.base[c] = reinterpret_cast<const std::byte*>(position.data() + c);
    arrays.radius_default = scene.radius;
    particles_.bind(arrays);
  }
  void build() { particles_.build(budget_); }
  const insitu::kernels::PkdTree& tree() const { return particles_.tree(); }

  std::vector<float> position;

 private:
  insitu::Budget budget_{0};
  insitu::Particles particles_;
};

// Bytes that malloc has handed out and not got back.
std::int64_t heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<std::int64_t>(info.uordblks + info.hblkhd);
}

double extra_bytes_per_particle(const ParticleScene& scene, ParticleOrder order, insitu::Workers& workers) {
  OwnParticles own(scene, order);
  const std::int64_t before = heap_bytes();
  workers.run([&] { own.build(); });
  malloc_trim(0);
  return static_cast<double>(heap_bytes() - before) / static_cast<double>(scene.count());
}

template <class Trace>
void for_tiles(std::size_t count, const Trace& trace) {
  const std::size_t tiles = (count + bench::tile_rays - 1) / bench::tile_rays;
  tbb::parallel_for(std::size_t{0}, tiles, [&](std::size_t tile) {
    const std::size_t begin = tile * bench::tile_rays;
    trace(begin, std::min(bench::tile_rays, count - begin));
  });
}

struct Worst {
  std::map<std::string, double> values;
  void note(const std::string& name, double value) {
    const auto [at, is_new] = values.emplace(name, value);
    if (!is_new) at->second = std::min(at->second, value);
  }
};

// The fastest way of Embree to trace some rays, found with one run of each.
struct BestWay {
  const EmbreeSpheres* spheres = nullptr;
  EmbreeTrace trace = EmbreeTrace::single;
  double seconds = 1e30;
  std::string name;
};

constexpr EmbreeTrace all_traces[] = {EmbreeTrace::single, EmbreeTrace::packet8, EmbreeTrace::packet16,
                                      EmbreeTrace::stream};

struct Candidate {
  std::string name;
  EmbreeGeometry geometry;
  std::unique_ptr<EmbreeSpheres> spheres;
};

BestWay find_best(const std::vector<Candidate>& candidates, EmbreeGeometry geometry, const std::vector<Ray>& rays,
                  bool occlusion, insitu::Workers& workers) {
  BestWay best;
  for (const EmbreeTrace trace : all_traces) {
    EmbreeRays prepared(rays, trace);
    for (const Candidate& candidate : candidates) {
      if (candidate.geometry != geometry) continue;
      const auto run = [&] {
        prepared.reset();
        const auto start = std::chrono::steady_clock::now();
        workers.run([&] {
          if (occlusion) {
            prepared.any_hits(candidate.spheres->scene(), false);
          } else {
            prepared.first_hits(candidate.spheres->scene(), true);
          }
        });
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      };
      const double seconds = run();
      if (seconds < best.seconds)
        best = {candidate.spheres.get(), trace, seconds, candidate.name + "/" + bench::name_of(trace)};
    }
  }
  return best;
}

void measure_view(const Options& options, const ParticleScene& scene, const std::string& view,
                  const std::vector<Candidate>& candidates, const OwnParticles& placed, const OwnParticles& indexed,
                  std::vector<insitu::Workers>& teams, Worst& worst, nlohmann::ordered_json& rows) {
  const std::vector<Ray> camera = bench::camera_rays(view, options.image_edge_px);
  std::vector<Hit> hits(camera.size());
  insitu::kernels::pkd_first_hits(placed.tree(), camera.data(), hits.data(), camera.size());
  const std::vector<Ray> ao = bench::occlusion_rays(camera, hits, placed.position, options.ao_reach);
  // The same rays for the index, whose items have other numbers.
  std::vector<Hit> index_hits(camera.size());
  insitu::kernels::pkd_first_hits(indexed.tree(), camera.data(), index_hits.data(), camera.size());
  std::vector<Ray> index_ao = ao;
  for (std::size_t i = 0, next = 0; i < camera.size(); ++i)
    if (hits[i].found()) index_ao[next++].exclude = index_hits[i].item;

  const BestWay sphere_camera = find_best(candidates, EmbreeGeometry::sphere_point, camera, false, teams.back());
  const BestWay sphere_ao = find_best(candidates, EmbreeGeometry::sphere_point, ao, true, teams.back());
  const BestWay user_camera = find_best(candidates, EmbreeGeometry::user_spheres, camera, false, teams.back());
  const BestWay user_ao = find_best(candidates, EmbreeGeometry::user_spheres, ao, true, teams.back());

  std::vector<double> frame_seconds;
  for (std::size_t threads = 1; threads <= teams.size(); ++threads) {
    insitu::Workers& workers = teams[threads - 1];
    std::vector<std::uint8_t> occluded(ao.size());
    std::vector<bench::Contender> contenders;
    const auto add_own = [&](const char* name, const OwnParticles& own, const std::vector<Ray>& own_ao) {
      contenders.push_back({std::string(name) + " camera", [&] { std::fill(hits.begin(), hits.end(), Hit{}); },
                            [&] {
                              workers.run([&] {
                                for_tiles(camera.size(), [&](std::size_t begin, std::size_t n) {
                                  insitu::kernels::pkd_first_hits(own.tree(), &camera[begin], &hits[begin], n);
                                });
                              });
                            }});
      contenders.push_back({std::string(name) + " ao", [&] { std::fill(occluded.begin(), occluded.end(), 0); },
                            [&] {
                              workers.run([&] {
                                for_tiles(own_ao.size(), [&](std::size_t begin, std::size_t n) {
                                  insitu::kernels::pkd_any_hits(own.tree(), &own_ao[begin], &occluded[begin], n);
                                });
                              });
                            }});
    };
    std::vector<std::unique_ptr<EmbreeRays>> prepared;
    const auto add_embree = [&](const BestWay& way, const std::vector<Ray>& rays, bool occlusion) {
      prepared.push_back(std::make_unique<EmbreeRays>(rays, way.trace));
      EmbreeRays* own = prepared.back().get();
      contenders.push_back({way.name, [own] { own->reset(); },
                            [own, &workers, scene_of = way.spheres->scene(), occlusion] {
                              workers.run([&] {
                                if (occlusion) {
                                  own->any_hits(scene_of, false);
                                } else {
                                  own->first_hits(scene_of, true);
                                }
                              });
                            }});
    };
    add_own("pkd", placed, ao);
    add_embree(sphere_camera, camera, false);
    add_embree(sphere_ao, ao, true);
    add_embree(user_camera, camera, false);
    add_embree(user_ao, ao, true);
    add_own("pkd index", indexed, index_ao);
    const std::vector<double> s = bench::take_turns(contenders, options.repetitions);

    const double own = s[0] + s[1];
    const double sphere = s[2] + s[3];
    const double best_camera = std::min(s[2], s[4]);
    const double best_ao = std::min(s[3], s[5]);
    frame_seconds.push_back(own);
    worst.note("pkd_ao_speed_vs_embree_sphere", sphere / own);
    worst.note("pkd_ao_speed_vs_embree_best", (best_camera + best_ao) / own);
    worst.note("pkd_primary_speed_vs_embree_sphere", s[2] / s[0]);
    worst.note("pkd_primary_speed_vs_embree_best", best_camera / s[0]);
    worst.note("pkd_index_ao_speed_vs_embree_sphere", sphere / (s[6] + s[7]));

    const auto mrays = [](std::size_t n, double seconds) { return static_cast<double>(n) / seconds / 1e6; };
    std::printf(
        "%-9s %4.0fM %-5s %zu thr | pkd %6.2f + %6.2f | sphere %6.2f + %6.2f | user %6.2f + %6.2f | index %6.2f + "
        "%6.2f "
        "Mrays/s | frame vs sphere %.2f, vs best %.2f\n",
        scene.name.c_str(), static_cast<double>(scene.count()) / 1e6, view.c_str(), threads, mrays(camera.size(), s[0]),
        mrays(ao.size(), s[1]), mrays(camera.size(), s[2]), mrays(ao.size(), s[3]), mrays(camera.size(), s[4]),
        mrays(ao.size(), s[5]), mrays(camera.size(), s[6]), mrays(ao.size(), s[7]), sphere / own,
        (best_camera + best_ao) / own);
    if (threads == teams.size())
      std::printf("%43s %s, %s; %s, %s\n", "Embree's best:", sphere_camera.name.c_str(), sphere_ao.name.c_str(),
                  user_camera.name.c_str(), user_ao.name.c_str());
    std::fflush(stdout);
    nlohmann::ordered_json row = {{"scene", scene.name}, {"particles", scene.count()},   {"view", view},
                                  {"threads", threads},  {"camera_rays", camera.size()}, {"ao_rays", ao.size()}};
    for (std::size_t i = 0; i < contenders.size(); ++i) row["seconds"][contenders[i].name] = s[i];
    rows.push_back(row);
  }
  if (frame_seconds.size() > 1) worst.note("scaling_2_threads", frame_seconds[0] / frame_seconds[1]);
}

void measure_scene(const Options& options, const std::string& name, std::uint64_t count,
                   std::vector<insitu::Workers>& teams, Worst& worst, std::map<std::string, double>& most,
                   bench::Report& report) {
  const ParticleScene scene = bench::make_scene(name, count);
  for (const auto& [metric, value] :
       bench::measure_builds({options.quick, options.repetitions}, scene, teams, report.context()["builds"]))
    worst.note(metric, value);
  if (name == "uniform")
    for (const auto& [metric, value] : bench::measure_displaced_rebuild({options.quick, options.repetitions}, scene,
                                                                        teams.back(), report.context()["rebuilds"]))
      worst.note(metric, value);
  if (options.builds_only) return;

  const auto note_most = [&most](const std::string& metric, double value) {
    most[metric] = std::max(most.emplace(metric, value).first->second, value);
  };
  note_most("pkd_extra_bytes_per_particle", extra_bytes_per_particle(scene, ParticleOrder::permute, teams.back()));
  note_most("pkd_index_extra_bytes_per_particle", extra_bytes_per_particle(scene, ParticleOrder::index, teams.back()));

  OwnParticles placed(scene, ParticleOrder::permute);
  OwnParticles indexed(scene, ParticleOrder::index);
  teams.back().run([&] {
    placed.build();
    indexed.build();
  });
  std::vector<Candidate> candidates;
  for (const EmbreeGeometry geometry : {EmbreeGeometry::sphere_point, EmbreeGeometry::user_spheres}) {
    for (const RTCBuildQuality quality : {RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_MEDIUM, RTC_BUILD_QUALITY_HIGH}) {
      if (options.quick && quality != RTC_BUILD_QUALITY_MEDIUM) continue;
      Candidate candidate{std::string(bench::name_of(geometry)) + "/" + bench::name_of(quality), geometry,
                          std::make_unique<EmbreeSpheres>(scene, geometry, quality)};
      teams.back().run([&] { candidate.spheres->build(); });
      const double bytes = static_cast<double>(candidate.spheres->bytes()) / static_cast<double>(count);
      note_most(std::string("embree_") + bench::name_of(geometry) + "_bytes_per_particle", bytes);
      candidates.push_back(std::move(candidate));
    }
  }
  for (const char* view : {"far", "close"})
    measure_view(options, scene, view, candidates, placed, indexed, teams, worst, report.context()["frames"]);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The P-k-d tree beside Embree, on the same particles and rays");
  Options options;
  app.add_flag("--quick", options.quick,
               "1M particles, 704 x 704 pixels, one build quality, 3 repetitions: within 45 s");
  app.add_flag("--builds-only", options.builds_only, "no frames");
  app.add_option("--json", options.json, "write {context, results} to this file");
  app.add_option("--particles", options.counts, "numbers of particles (default 1000000 and 10000000)");
  app.add_option("--scenes", options.scenes, "uniform, clustered")->capture_default_str();
  app.add_option("--repetitions", options.repetitions, "of which the median counts")->capture_default_str();
  options.ao_reach = std::numeric_limits<double>::infinity();
  app.add_option("--ao-reach", options.ao_reach, "length of occlusion rays; the cloud has size 1 (default: infinite)");
  CLI11_PARSE(app, argc, argv);
  if (options.quick) {
    options.repetitions = std::min(options.repetitions, 3);
    options.image_edge_px = 704;
  }
  if (options.counts.empty())
    options.counts =
        options.quick ? std::vector<std::uint64_t>{1000000} : std::vector<std::uint64_t>{1000000, 10000000};

  bench::Report report(argc, argv);
  report.context()["image_edge_px"] = options.image_edge_px;
  std::vector<insitu::Workers> teams;
  teams.emplace_back(1);
  teams.emplace_back(2);
  Worst worst;
  std::map<std::string, double> most;
  for (const std::uint64_t count : options.counts)
    for (const std::string& name : options.scenes) measure_scene(options, name, count, teams, worst, most, report);

  for (const auto& [metric, value] :
       bench::measure_melt_rebuild({options.quick, options.repetitions}, teams.back(), report.context()["rebuilds"]))
    worst.note(metric, value);

  std::printf("\n");
  for (const auto& values : {most, worst.values})
    for (const auto& [name, value] : values) {
      std::printf("%-45s %.3f\n", name.c_str(), value);
      report.results()[name] = value;
    }
  if (!report.write(options.json)) {
    std::fprintf(stderr, "%s could not be written\n", options.json.c_str());
    return 1;
  }
}
