#include "paper_variants.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>

#include "core/stopwatch.h"
#include "measure.h"
#include "own_particles.h"
#include "paper_tree.h"
#include "ray_tiles.h"

namespace bench {
namespace {

using insitu::kernels::Hit;
using insitu::kernels::Ray;

// One structure with one traversal. Each structure knows the particles by places of its own, so that the particles that
// occlusion rays start on differ.
struct Variant {
  std::string name;
  std::function<void(const Ray*, Hit*, std::size_t)> first_hits;
  std::function<void(const Ray*, std::uint8_t*, std::size_t)> any_hits;
  std::vector<Ray> ao;
};

struct BuiltTree {
  std::string name;
  std::unique_ptr<PaperTree> tree;
  double build_s;
};

struct Seconds {
  double camera;
  double ao;
  double frame() const { return camera + ao; }
};

BuiltTree build(const ParticleScene& scene, TreeLayout layout, AxisRule rule, insitu::Workers& workers) {
  BuiltTree built;
  built.name = std::string(layout == TreeLayout::heap ? "heap" : "in order") +
               (rule == AxisRule::round_robin ? " round robin" : " longest side");
  const insitu::Stopwatch watch;
  workers.run([&] {
    built.tree = std::make_unique<PaperTree>(scene.position, scene.radius, layout, rule, PaperTree::Items::by_place);
  });
  built.build_s = watch.seconds();
  return built;
}

Variant paper_variant(const BuiltTree& built, RayWay way) {
  const PaperTree& tree = *built.tree;
  return {
      built.name + (way == RayWay::single ? " single" : " packet"),
      [&tree, way](const Ray* rays, Hit* hits, std::size_t n) { tree.first_hits(way, rays, hits, n); },
      [&tree, way](const Ray* rays, std::uint8_t* occluded, std::size_t n) { tree.any_hits(way, rays, occluded, n); },
      {}};
}

// The same occlusion rays for all, from the hits of the first.
void prepare_ao(std::vector<Variant>& variants, const std::vector<Ray>& camera, const std::vector<float>& position,
                double ao_reach) {
  std::vector<Hit> hits(camera.size());
  variants.front().first_hits(camera.data(), hits.data(), camera.size());
  variants.front().ao = occlusion_rays(camera, hits, position, ao_reach);
  for (std::size_t k = 1; k < variants.size(); ++k) {
    std::vector<Hit> own(camera.size());
    variants[k].first_hits(camera.data(), own.data(), camera.size());
    variants[k].ao = variants.front().ao;
    for (std::size_t i = 0, next = 0; i < camera.size(); ++i)
      if (hits[i].found()) variants[k].ao[next++].exclude = own[i].item;
  }
}

std::vector<Seconds> measure(const std::vector<Variant>& variants, const std::vector<Ray>& camera,
                             insitu::Workers& workers, int repetitions) {
  std::vector<Hit> hits(camera.size());
  std::vector<std::uint8_t> occluded(variants.front().ao.size());
  std::vector<Contender> contenders;
  for (const Variant& variant : variants) {
    contenders.push_back({variant.name + " camera", [&] { std::fill(hits.begin(), hits.end(), Hit{}); },
                          [&] {
                            workers.run([&] {
                              for_tiles(camera.size(), [&](std::size_t begin, std::size_t n) {
                                variant.first_hits(&camera[begin], &hits[begin], n);
                              });
                            });
                          }});
    contenders.push_back({variant.name + " ao", [&] { std::fill(occluded.begin(), occluded.end(), 0); },
                          [&] {
                            workers.run([&] {
                              for_tiles(variant.ao.size(), [&](std::size_t begin, std::size_t n) {
                                variant.any_hits(&variant.ao[begin], &occluded[begin], n);
                              });
                            });
                          }});
  }
  const std::vector<double> s = take_turns(contenders, repetitions);
  std::vector<Seconds> seconds;
  for (std::size_t k = 0; k < variants.size(); ++k) seconds.push_back({s[2 * k], s[2 * k + 1]});
  return seconds;
}

}  // namespace

std::map<std::string, double> VariantSpeeds::metrics() const {
  std::map<std::string, double> metrics;
  for (const auto& [name, speeds] : speeds_) {
    metrics[name] = *std::max_element(speeds.begin(), speeds.end());
    metrics[name + "_typical"] = median(speeds);
  }
  return metrics;
}

void measure_paper_variants(const FrameOptions& options, const ParticleScene& scene, insitu::Workers& workers,
                            VariantSpeeds& speeds, nlohmann::ordered_json& rows) {
  OwnParticles own(scene, insitu::ParticleOrder::permute, 0.0);
  const insitu::Stopwatch watch;
  workers.run([&] { own.build(); });
  const double own_build_s = watch.seconds();
  std::vector<BuiltTree> trees;
  for (const AxisRule rule : {AxisRule::round_robin, AxisRule::longest_side})
    for (const TreeLayout layout : {TreeLayout::heap, TreeLayout::in_order})
      if (!options.quick || rule == AxisRule::round_robin || layout == TreeLayout::heap)
        trees.push_back(build(scene, layout, rule, workers));
  std::printf("%-9s %4.1fM build, s: ours %.3f", scene.name.c_str(), static_cast<double>(scene.count()) / 1e6,
              own_build_s);
  for (const BuiltTree& built : trees) std::printf(", %s %.3f", built.name.c_str(), built.build_s);
  std::printf("\n");

  std::vector<Variant> variants;
  variants.push_back(
      {"ours",
       [&](const Ray* rays, Hit* hits, std::size_t n) { own.set().first_hits(rays, hits, n); },
       [&](const Ray* rays, std::uint8_t* occluded, std::size_t n) { own.set().any_hits(rays, occluded, n); },
       {}});
  std::vector<std::size_t> heap;  // the variants of the paper
  std::size_t round_robin = 0;
  std::size_t longest_in_heap = 0;
  std::size_t longest_in_order = 0;
  for (const BuiltTree& built : trees) {
    const bool is_heap = built.tree->layout() == TreeLayout::heap;
    if (!is_heap && built.tree->rule() == AxisRule::round_robin) {
      const PaperTree& tree = *built.tree;
      round_robin = variants.size();
      variants.push_back(
          {"ours round robin",
           [&tree](const Ray* rays, Hit* hits, std::size_t n) { tree.library_first_hits(rays, hits, n); },
           [&tree](const Ray* rays, std::uint8_t* occluded, std::size_t n) {
             tree.library_any_hits(rays, occluded, n);
           },
           {}});
      continue;
    }
    if (built.tree->rule() == AxisRule::longest_side) (is_heap ? longest_in_heap : longest_in_order) = variants.size();
    for (const RayWay way : {RayWay::single, RayWay::packet}) {
      if (is_heap) heap.push_back(variants.size());
      variants.push_back(paper_variant(built, way));
    }
  }

  for (const char* view : {"far", "close"}) {
    const std::vector<Ray> camera = camera_rays(view, std::min(options.image_edge_px, options.quick ? 128u : 512u));
    prepare_ao(variants, camera, own.position, options.ao_reach);
    const std::vector<Seconds> s = measure(variants, camera, workers, options.repetitions);
    const double ours = s.front().frame();
    Seconds paper = s[heap.front()];
    for (const std::size_t k : heap) paper = {std::min(paper.camera, s[k].camera), std::min(paper.ao, s[k].ao)};
    speeds.note("heap_order_speed", ours / paper.frame());
    speeds.note("heap_order_camera_speed", s.front().camera / paper.camera);
    speeds.note("round_robin_speed", ours / s[round_robin].frame());
    if (longest_in_order != 0)
      speeds.note("heap_over_in_order_speed", (s[longest_in_order + 1].camera + s[longest_in_order].ao) /
                                                  (s[longest_in_heap + 1].camera + s[longest_in_heap].ao));
    const std::size_t ao_rays = variants.front().ao.size();
    std::printf("%-9s %4.1fM %-5s", scene.name.c_str(), static_cast<double>(scene.count()) / 1e6, view);
    nlohmann::ordered_json row = {{"scene", scene.name},
                                  {"particles", scene.count()},
                                  {"view", view},
                                  {"camera_rays", camera.size()},
                                  {"ao_rays", ao_rays}};
    for (const BuiltTree& built : trees) row["build_seconds"][built.name] = built.build_s;
    row["build_seconds"]["ours"] = own_build_s;
    for (std::size_t k = 0; k < variants.size(); ++k) {
      std::printf("%s %s %.2f + %.2f", k == 0 ? "" : " |", variants[k].name.c_str(),
                  static_cast<double>(camera.size()) / s[k].camera / 1e6, static_cast<double>(ao_rays) / s[k].ao / 1e6);
      row["seconds"][variants[k].name] = {s[k].camera, s[k].ao};
    }
    std::printf(" Mrays/s\n");
    std::fflush(stdout);
    rows.push_back(row);
  }
}

}  // namespace bench
