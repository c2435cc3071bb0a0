#include "particle_frames.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>

#include "embree_spheres.h"
#include "measure.h"
#include "own_particles.h"
#include "ray_tiles.h"

namespace bench {
namespace {

using insitu::ParticleOrder;
using insitu::kernels::Hit;
using insitu::kernels::Ray;

// Of more particles Embree's structures and ours together would not fit into 24 GB.
constexpr std::uint64_t most_side_by_side = 20000000;

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

void trace_embree(EmbreeRays& rays, RTCScene scene, bool occlusion) {
  if (occlusion) {
    rays.any_hits(scene, false);
  } else {
    rays.first_hits(scene, true);
  }
}

BestWay find_best(const std::vector<Candidate>& candidates, EmbreeGeometry geometry, const std::vector<Ray>& rays,
                  bool occlusion, insitu::Workers& workers) {
  BestWay best;
  for (const EmbreeTrace trace : all_traces) {
    EmbreeRays prepared(rays, trace);
    for (const Candidate& candidate : candidates) {
      if (candidate.geometry != geometry) continue;
      prepared.reset();
      const auto start = std::chrono::steady_clock::now();
      workers.run([&] { trace_embree(prepared, candidate.spheres->scene(), occlusion); });
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (seconds < best.seconds)
        best = {candidate.spheres.get(), trace, seconds, candidate.name + "/" + name_of(trace)};
    }
  }
  return best;
}

// One of our structures over the particles, with the occlusion rays of a view: the same rays for all, but each knows
// the particles by numbers of its own.
struct Own {
  std::string name;
  std::unique_ptr<OwnParticles> particles;
  std::vector<Ray> ao;
};

std::vector<Hit> trace_camera(const Own& own, const std::vector<Ray>& camera) {
  std::vector<Hit> hits(camera.size());
  own.particles->set().first_hits(camera.data(), hits.data(), camera.size());
  return hits;
}

void prepare_view(std::vector<Own>& owns, const std::vector<Ray>& camera, double ao_reach) {
  const std::vector<Hit> hits = trace_camera(owns.front(), camera);
  owns.front().ao = occlusion_rays(camera, hits, owns.front().particles->position, ao_reach);
  for (std::size_t k = 1; k < owns.size(); ++k) {
    const std::vector<Hit> own_hits = trace_camera(owns[k], camera);
    owns[k].ao = owns.front().ao;
    for (std::size_t i = 0, next = 0; i < camera.size(); ++i)
      if (hits[i].found()) owns[k].ao[next++].exclude = own_hits[i].item;
  }
}

struct Seconds {
  double camera = 0.0;
  double ao = 0.0;
  double frame() const { return camera + ao; }
};

constexpr EmbreeGeometry all_geometries[] = {EmbreeGeometry::sphere_point, EmbreeGeometry::user_spheres};

// One view with some number of threads, from one pass or several: each has some of Embree's structures, and all of
// ours.
struct ViewTimes {
  Seconds embree[2];  // by geometry, each at its best
  std::string embree_ways[2];
  std::vector<std::vector<Seconds>> own;  // by structure, one for each pass

  Seconds own_mean(std::size_t k) const {
    Seconds mean;
    for (const Seconds& pass : own[k]) {
      mean.camera += pass.camera / static_cast<double>(own[k].size());
      mean.ao += pass.ao / static_cast<double>(own[k].size());
    }
    return mean;
  }
};

struct View {
  std::string name;
  std::vector<Ray> camera;
  std::size_t ao_rays = 0;
  std::vector<ViewTimes> times;  // by number of threads, less one
};

// A pass: those of Embree's structures that there are, and ours, take turns.
void time_view(const FrameOptions& options, const ParticleScene& scene, const std::vector<Candidate>& candidates,
               std::vector<Own>& owns, std::vector<insitu::Workers>& teams, View& view, nlohmann::ordered_json& rows) {
  prepare_view(owns, view.camera, options.ao_reach);
  const std::vector<Ray>& camera = view.camera;
  const std::vector<Ray>& ao = owns.front().ao;
  view.ao_rays = ao.size();
  struct Baseline {
    std::size_t geometry;
    BestWay ways[2];  // camera, occlusion
  };
  std::vector<Baseline> baselines;
  for (const EmbreeGeometry geometry : all_geometries) {
    Baseline one{static_cast<std::size_t>(geometry),
                 {find_best(candidates, geometry, camera, false, teams.back()),
                  find_best(candidates, geometry, ao, true, teams.back())}};
    if (one.ways[0].spheres != nullptr) baselines.push_back(std::move(one));
  }

  for (std::size_t threads = 1; threads <= teams.size(); ++threads) {
    insitu::Workers& workers = teams[threads - 1];
    std::vector<Hit> hits(camera.size());
    std::vector<std::uint8_t> occluded(ao.size());
    std::vector<Contender> contenders;
    std::vector<std::unique_ptr<EmbreeRays>> prepared;
    for (const Baseline& baseline : baselines) {
      for (const bool occlusion : {false, true}) {
        const BestWay& way = baseline.ways[occlusion ? 1 : 0];
        prepared.push_back(std::make_unique<EmbreeRays>(occlusion ? ao : camera, way.trace));
        EmbreeRays* rays = prepared.back().get();
        contenders.push_back({way.name, [rays] { rays->reset(); },
                              [rays, &workers, spheres = way.spheres, occlusion] {
                                workers.run([&] { trace_embree(*rays, spheres->scene(), occlusion); });
                              }});
      }
    }
    for (const Own& own : owns) {
      contenders.push_back({own.name + " camera", [&] { std::fill(hits.begin(), hits.end(), Hit{}); },
                            [&] {
                              workers.run([&] {
                                for_tiles(camera.size(), [&](std::size_t begin, std::size_t n) {
                                  own.particles->set().first_hits(&camera[begin], &hits[begin], n);
                                });
                              });
                            }});
      contenders.push_back({own.name + " ao", [&] { std::fill(occluded.begin(), occluded.end(), 0); },
                            [&] {
                              workers.run([&] {
                                for_tiles(own.ao.size(), [&](std::size_t begin, std::size_t n) {
                                  own.particles->set().any_hits(&own.ao[begin], &occluded[begin], n);
                                });
                              });
                            }});
    }
    const std::vector<double> s = take_turns(contenders, options.repetitions);
    ViewTimes& times = view.times[threads - 1];
    std::size_t next = 0;
    for (const Baseline& baseline : baselines) {
      times.embree[baseline.geometry] = {s[next], s[next + 1]};
      times.embree_ways[baseline.geometry] = baseline.ways[0].name + ", " + baseline.ways[1].name;
      next += 2;
    }
    times.own.resize(owns.size());
    for (std::size_t k = 0; k < owns.size(); ++k, next += 2) times.own[k].push_back({s[next], s[next + 1]});
    nlohmann::ordered_json row = {{"scene", scene.name}, {"particles", scene.count()},   {"view", view.name},
                                  {"threads", threads},  {"camera_rays", camera.size()}, {"ao_rays", ao.size()}};
    for (std::size_t i = 0; i < contenders.size(); ++i) row["seconds"][contenders[i].name] = s[i];
    rows.push_back(row);
  }
}

void note_view(const ParticleScene& scene, const View& view, const std::vector<Own>& owns, FrameMetrics& metrics) {
  std::vector<std::vector<double>> own_frames(owns.size());
  for (std::size_t threads = 1; threads <= view.times.size(); ++threads) {
    const ViewTimes& times = view.times[threads - 1];
    const Seconds& sphere = times.embree[0];
    const Seconds best{std::min(sphere.camera, times.embree[1].camera), std::min(sphere.ao, times.embree[1].ao)};
    const auto mrays = [](std::size_t n, double seconds) { return static_cast<double>(n) / seconds / 1e6; };
    const auto print = [&](const char* name, const Seconds& s) {
      std::printf(" | %s %.2f + %.2f", name, mrays(view.camera.size(), s.camera), mrays(view.ao_rays, s.ao));
    };
    std::printf("%-9s %4.1fM %-5s %zu thr", scene.name.c_str(), static_cast<double>(scene.count()) / 1e6,
                view.name.c_str(), threads);
    print("sphere", sphere);
    print("user", times.embree[1]);
    for (std::size_t k = 0; k < owns.size(); ++k) {
      const Seconds own = times.own_mean(k);
      own_frames[k].push_back(own.frame());
      const std::string& name = owns[k].name;
      print(name.c_str(), own);
      metrics.note_speed(name + "_ao_speed_vs_embree_sphere", sphere.frame() / own.frame());
      metrics.note_speed(name + "_ao_speed_vs_embree_best", best.frame() / own.frame());
      metrics.note_speed(name + "_primary_speed_vs_embree_sphere", sphere.camera / own.camera);
      metrics.note_speed(name + "_primary_speed_vs_embree_best", best.camera / own.camera);
    }
    std::printf(" Mrays/s | frame vs sphere, vs best:");
    for (std::size_t k = 0; k < owns.size(); ++k)
      std::printf(" %s %.2f %.2f", owns[k].name.c_str(), sphere.frame() / own_frames[k].back(),
                  best.frame() / own_frames[k].back());
    std::printf("\n");
  }
  std::printf("%28s %s; %s\n", "Embree's best:", view.times.back().embree_ways[0].c_str(),
              view.times.back().embree_ways[1].c_str());
  std::fflush(stdout);
  if (view.times.size() > 1)
    for (std::size_t k = 0; k < owns.size(); ++k)
      metrics.note_speed((k == 0 ? "" : owns[k].name + "_") + "scaling_2_threads", own_frames[k][0] / own_frames[k][1]);
}

std::vector<Candidate> build_embree(const std::vector<EmbreeGeometry>& geometries,
                                    const std::vector<RTCBuildQuality>& qualities, const ParticleScene& scene,
                                    insitu::Workers& workers, FrameMetrics& metrics) {
  std::vector<Candidate> candidates;
  for (const EmbreeGeometry geometry : geometries) {
    for (const RTCBuildQuality quality : qualities) {
      Candidate candidate{std::string(name_of(geometry)) + "/" + name_of(quality), geometry,
                          std::make_unique<EmbreeSpheres>(scene, geometry, quality)};
      workers.run([&] { candidate.spheres->build(); });
      metrics.note_cost(std::string("embree_") + name_of(geometry) + "_bytes_per_particle",
                        static_cast<double>(candidate.spheres->bytes()) / static_cast<double>(scene.count()));
      candidates.push_back(std::move(candidate));
    }
  }
  return candidates;
}

}  // namespace

void measure_frames(const FrameOptions& options, const ParticleScene& scene, std::vector<insitu::Workers>& teams,
                    FrameMetrics& metrics, nlohmann::ordered_json& rows) {
  insitu::Workers& workers = teams.back();
  metrics.note_cost("pkd_extra_bytes_per_particle",
                    extra_bytes_per_particle(scene, ParticleOrder::permute, 0.0, workers));
  metrics.note_cost("pkd_index_extra_bytes_per_particle",
                    extra_bytes_per_particle(scene, ParticleOrder::index, 0.0, workers));

  // All at once, or, of many particles, one of Embree's structures after another, each beside ours.
  const bool at_once = scene.count() <= most_side_by_side;
  std::vector<Own> owns;
  const auto add = [&](const char* name, ParticleOrder order, double share) {
    owns.push_back({name, std::make_unique<OwnParticles>(scene, order, share), {}});
    workers.run([&] { owns.back().particles->build(); });
  };
  add("pkd", ParticleOrder::permute, 0.0);
  add("treelet", ParticleOrder::permute, options.treelet_share);
  if (at_once) {
    add("pkd_index", ParticleOrder::index, 0.0);
    add("treelet_index", ParticleOrder::index, options.treelet_share);
  }
  const OwnParticles& treelet = *owns[1].particles;
  metrics.note_cost("treelet_bytes_ratio",
                    static_cast<double>(treelet.set().treelet_bytes()) / static_cast<double>(treelet.data_bytes()));

  std::vector<RTCBuildQuality> qualities = {RTC_BUILD_QUALITY_MEDIUM};
  if (at_once && !options.quick) qualities = {RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_MEDIUM, RTC_BUILD_QUALITY_HIGH};
  std::vector<View> views;
  for (const char* name : {"far", "close"})
    views.push_back({name, camera_rays(name, options.image_edge_px), 0, std::vector<ViewTimes>(teams.size())});
  const auto pass = [&](const std::vector<EmbreeGeometry>& geometries) {
    const std::vector<Candidate> candidates = build_embree(geometries, qualities, scene, workers, metrics);
    for (View& view : views) time_view(options, scene, candidates, owns, teams, view, rows);
  };
  if (at_once) {
    pass({EmbreeGeometry::sphere_point, EmbreeGeometry::user_spheres});
  } else {
    for (const EmbreeGeometry geometry : all_geometries) pass({geometry});
  }
  for (const View& view : views) note_view(scene, view, owns, metrics);
}

}  // namespace bench
