// Instructions per ray, counted by callgrind: the same in every run, whatever else the machine does. The program runs
// itself under valgrind, which emulates a processor with AVX2: what a wider instruction set makes of the same code, and
// what memory takes, it does not know.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <sstream>

#include "measure.h"
#include "own_particles.h"
#include "paper_tree.h"
#include "temporary_folder.h"

using insitu::ParticleOrder;
using insitu::kernels::Hit;
using insitu::kernels::Ray;

namespace {

std::function<void()> counted_work;

}  // namespace

// callgrind counts from where this is entered to where it is left.
extern "C" [[gnu::noinline]] void insitu_bench_counted() { counted_work(); }

namespace {

struct Options {
  bool quick = false;
  std::string json;
  std::uint64_t particles = 100000;
  std::string child;  // directory for its list of counts; empty: this is the parent
};

// One of the structures that are compared.
struct Structure {
  std::string name;
  std::unique_ptr<bench::OwnParticles> own;
  std::unique_ptr<bench::PaperTree> paper;

  void first_hits(const std::vector<Ray>& rays, std::vector<Hit>& hits) const {
    if (own) return own->set().first_hits(rays.data(), hits.data(), rays.size());
    paper->first_hits(bench::RayWay::packet, rays.data(), hits.data(), rays.size());
  }
  void any_hits(const std::vector<Ray>& rays, std::vector<std::uint8_t>& occluded) const {
    if (own) return own->set().any_hits(rays.data(), occluded.data(), rays.size());
    paper->any_hits(bench::RayWay::single, rays.data(), occluded.data(), rays.size());
  }
  const std::vector<float>& position() const { return own ? own->position : paper->position(); }
};

std::vector<Structure> structures_over(const bench::ParticleScene& scene, insitu::Workers& workers) {
  constexpr double share = 0.15;
  constexpr std::uint64_t tenth = 10;
  bench::ParticleScene chosen = scene;  // every tenth by chance: the scenes are in random order
  bench::ParticleScene left = scene;
  left.position.clear();
  for (std::uint64_t i = 0; i < scene.count(); ++i) {
    chosen.values.push_back(i % tenth == 0 ? 1.0f : 0.0f);
    if (i % tenth == 0) left.position.insert(left.position.end(), &scene.position[3 * i], &scene.position[3 * i] + 3);
  }
  std::vector<insitu::FilterTerm> terms(1);
  terms[0].attribute = "value";
  terms[0].range[0] = 0.5;
  terms[0].range[1] = std::numeric_limits<double>::infinity();

  std::vector<Structure> structures;
  const auto add = [&](const char* name, const bench::ParticleScene& of, ParticleOrder order, double treelet_share) {
    structures.push_back({name, std::make_unique<bench::OwnParticles>(of, order, treelet_share), nullptr});
  };
  add("pkd", scene, ParticleOrder::permute, 0.0);
  add("treelet", scene, ParticleOrder::permute, share);
  add("pkd_index", scene, ParticleOrder::index, 0.0);
  add("treelet_index", scene, ParticleOrder::index, share);
  add("tenth_alone", left, ParticleOrder::permute, share);
  add("tenth_filtered", chosen, ParticleOrder::permute, share);
  structures.back().own->filter(std::make_shared<const insitu::Filter>(std::move(terms)));
  workers.run([&] {
    for (const Structure& one : structures) one.own->build();
    structures.push_back(
        {"paper", nullptr,
         std::make_unique<bench::PaperTree>(scene.position, scene.radius, bench::TreeLayout::heap,
                                            bench::AxisRule::longest_side, bench::PaperTree::Items::by_place)});
  });
  return structures;
}

// Under callgrind: a line "name rays" for each count that is taken.
int trace_all(const Options& options) {
  std::ofstream list(options.child + "/list");
  insitu::Workers workers(1);
  const auto count = [&](const std::string& name, std::size_t rays, const std::function<void()>& work) {
    list << name << ' ' << rays << '\n' << std::flush;
    counted_work = work;
    insitu_bench_counted();
  };
  for (const char* scene_name : {"uniform", "clustered"}) {
    const bench::ParticleScene scene = bench::make_scene(scene_name, options.particles);
    for (const Structure& one : structures_over(scene, workers)) {
      for (const char* view : {"far", "close"}) {
        const std::string name = one.name + "_" + scene_name + "_" + view;
        const std::vector<Ray> camera = bench::camera_rays(view, options.quick ? 64 : 256);
        std::vector<Hit> hits(camera.size());
        count("camera_" + name, camera.size(), [&] { one.first_hits(camera, hits); });
        const std::vector<Ray> ao =
            bench::occlusion_rays(camera, hits, one.position(), std::numeric_limits<double>::infinity());
        std::vector<std::uint8_t> occluded(ao.size());
        count("ao_" + name, ao.size(), [&] { one.any_hits(ao, occluded); });
      }
    }
  }
  return list ? EXIT_SUCCESS : EXIT_FAILURE;
}

double instructions_in(const std::filesystem::path& dump) {
  std::ifstream file(dump);
  for (std::string line; std::getline(file, line);)
    if (line.rfind("summary: ", 0) == 0) return std::stod(line.substr(9));
  throw std::runtime_error(dump.string() + " has no summary");
}

// Instructions per ray, by name.
std::map<std::string, double> count_all(const Options& options, const std::string& directory) {
  std::ostringstream command;
  command << "valgrind --quiet --tool=callgrind --zero-before=insitu_bench_counted --dump-after=insitu_bench_counted"
          << " --callgrind-out-file=" << directory << "/out "
          << std::filesystem::read_symlink("/proc/self/exe").string() << " --child " << directory << " --particles "
          << options.particles << (options.quick ? " --quick" : "");
  if (std::system(command.str().c_str()) != 0)
    throw std::runtime_error("valgrind failed; it comes with Debian's package valgrind");
  std::map<std::string, double> counts;
  std::ifstream list(directory + "/list");
  std::string name;
  double rays = 0.0;
  for (int number = 1; list >> name >> rays; ++number)
    counts[name] = instructions_in(directory + "/out." + std::to_string(number)) / rays;
  return counts;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Instructions per ray, counted by callgrind");
  app.add_flag("--quick", options.quick, "20,000 particles, 64 x 64 pixels: within 45 s");
  app.add_option("--json", options.json, "write {context, results} to this file");
  app.add_option("--particles", options.particles, "number of particles")->capture_default_str();
  app.add_option("--child", options.child)->group("");
  CLI11_PARSE(app, argc, argv);
  if (options.quick && options.child.empty()) options.particles = 20000;
  if (!options.child.empty()) return trace_all(options);
  try {
    const insitu::testing::TemporaryFolder folder;
    const std::map<std::string, double> counts = count_all(options, folder.path().string());
    bench::Report report(argc, argv);
    std::printf("instructions per ray, AVX2, %llu particles\n", static_cast<unsigned long long>(options.particles));
    for (const auto& [name, count] : counts) {
      std::printf("%-36s %9.0f\n", name.c_str(), count);
      report.results()["instructions_per_ray_" + name] = std::round(count);
    }
    return report.write(options.json) ? EXIT_SUCCESS : EXIT_FAILURE;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
}
