#include "particle_builds.h"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "embree_spheres.h"
#include "geometry/particles/particles.h"
#include "measure.h"

namespace bench {
namespace {

using insitu::ParticleOrder;

template <class T>
insitu::kernels::ArrayView view_of(const std::vector<T>& values, std::uint32_t components,
                                   insitu::kernels::Scalar type) {
  insitu::kernels::ArrayView view;
  view.type = type;
  view.components = components;
  view.count = values.size() / components;
  view.stride = static_cast<std::ptrdiff_t>(components * sizeof(T));
  for (std::uint32_t c = 0; c < components && c < 4; ++c)
    view.base[c] = reinterpret_cast<const std::byte*>(values.data() + c);
  return view;
}

// Particles with the arrays that a simulation may have besides positions.
class BuildParticles {
 public:
  BuildParticles(const ParticleScene& scene, ParticleOrder order, int columns)
      : position_(scene.position), particles_("particles", order, false) {
    insitu::ParticleArrays arrays;
    arrays.position = view_of(position_, 3, insitu::kernels::Scalar::f32);
    arrays.radius_default = scene.radius;
    const std::size_t count = scene.count();
    if (columns >= 2) arrays.payload.push_back(view_of(velocity_ = position_, 3, insitu::kernels::Scalar::f32));
    if (columns >= 3) {
      id_.resize(count);
      for (std::size_t i = 0; i < count; ++i) id_[i] = static_cast<std::int64_t>(i);
      arrays.payload.push_back(view_of(id_, 1, insitu::kernels::Scalar::i64));
    }
    if (columns >= 4)
      arrays.payload.push_back(view_of(mass_ = std::vector<float>(count, 1.0f), 1, insitu::kernels::Scalar::f32));
    if (columns >= 5)
      arrays.payload.push_back(view_of(charge_ = std::vector<float>(count, 0.0f), 1, insitu::kernels::Scalar::f32));
    particles_.bind(arrays);
  }
  void build() { particles_.build(budget_); }

 private:
  std::vector<float> position_;
  std::vector<float> velocity_;
  std::vector<std::int64_t> id_;
  std::vector<float> mass_;
  std::vector<float> charge_;
  insitu::Budget budget_{0};
  insitu::Particles particles_;
};

// The same tree by the standard library: what one gets without work.
struct Record {
  float x[3];
};

void nth_element_tree(Record* records, std::size_t count, insitu::kernels::PkdBox<float> box) {
  while (count > insitu::kernels::pkd_leaf_size && !box.is_point()) {
    const int axis = box.split_axis();
    const std::size_t mid = count / 2;
    std::nth_element(records, records + mid, records + count,
                     [axis](const Record& a, const Record& b) { return a.x[axis] < b.x[axis]; });
    insitu::kernels::PkdBox<float> left = box;
    left.upper[axis] = box.lower[axis] = records[mid].x[axis];
    nth_element_tree(records, mid, left);
    records += mid + 1;
    count -= mid + 1;
  }
}

void nth_element_build(std::vector<Record>& records) {
  insitu::kernels::PkdBox<float> box;
  for (int c = 0; c < 3; ++c) {
    const auto [low, high] = std::minmax_element(records.begin(), records.end(),
                                                 [c](const Record& a, const Record& b) { return a.x[c] < b.x[c]; });
    box.lower[c] = low->x[c];
    box.upper[c] = high->x[c];
  }
  nth_element_tree(records.data(), records.size(), box);
}

}  // namespace

std::map<std::string, double> measure_builds(const BuildOptions& options, const ParticleScene& scene,
                                             std::vector<insitu::Workers>& teams, nlohmann::ordered_json& rows) {
  insitu::Workers& all = teams.back();
  std::vector<Contender> contenders;
  std::unique_ptr<BuildParticles> own;
  const auto add_own = [&](const std::string& name, ParticleOrder order, int columns, insitu::Workers& workers) {
    contenders.push_back({name,
                          [&, order, columns] {
                            own.reset();
                            own = std::make_unique<BuildParticles>(scene, order, columns);
                          },
                          [&] { workers.run([&] { own->build(); }); }});
  };
  std::unique_ptr<EmbreeSpheres> embree;
  const auto add_embree = [&](EmbreeGeometry geometry, RTCBuildQuality quality) {
    contenders.push_back({std::string(name_of(geometry)) + " " + name_of(quality),
                          [&, geometry, quality] {
                            embree.reset();
                            embree = std::make_unique<EmbreeSpheres>(scene, geometry, quality);
                          },
                          [&] { all.run([&] { embree->build(); }); }});
  };
  add_own("permute", ParticleOrder::permute, 1, all);
  add_embree(EmbreeGeometry::sphere_point, RTC_BUILD_QUALITY_LOW);
  if (!options.quick) add_embree(EmbreeGeometry::sphere_point, RTC_BUILD_QUALITY_MEDIUM);
  if (!options.quick) add_embree(EmbreeGeometry::sphere_point, RTC_BUILD_QUALITY_HIGH);
  add_embree(EmbreeGeometry::user_spheres, RTC_BUILD_QUALITY_LOW);
  add_own("index", ParticleOrder::index, 1, all);
  add_own("copy", ParticleOrder::copy, 1, all);
  add_own("permute 1 thread", ParticleOrder::permute, 1, teams.front());
  std::vector<Record> records;
  contenders.push_back({"nth_element 1 thread",
                        [&] {
                          records.resize(scene.count());
                          std::memcpy(records.data(), scene.position.data(), scene.position.size() * sizeof(float));
                        },
                        [&] { nth_element_build(records); }});
  if (!options.quick) {
    add_own("permute 3 columns", ParticleOrder::permute, 3, all);
    add_own("permute 5 columns", ParticleOrder::permute, 5, all);
  }
  const std::vector<double> s = take_turns(contenders, options.repetitions);

  std::map<std::string, double> seconds;
  double sphere = 1e30;
  std::printf("%-9s %4.0fM build, million particles/s:", scene.name.c_str(), static_cast<double>(scene.count()) / 1e6);
  nlohmann::ordered_json row = {{"scene", scene.name}, {"particles", scene.count()}};
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    const std::string& name = contenders[i].name;
    seconds[name] = s[i];
    if (name.rfind("sphere", 0) == 0) sphere = std::min(sphere, s[i]);
    std::printf("  %s %.2f", name.c_str(), static_cast<double>(scene.count()) / s[i] / 1e6);
    row["seconds"][name] = s[i];
  }
  std::printf("\n");
  rows.push_back(row);
  const auto million_per_s = [&](const char* name) {
    return static_cast<double>(scene.count()) / seconds.at(name) / 1e6;
  };
  return {{"build_speed_vs_embree_sphere", sphere / seconds.at("permute")},
          {"build_speed_vs_embree_morton", seconds.at("user_spheres low") / seconds.at("permute")},
          {"build_index_speed_vs_embree_sphere", sphere / seconds.at("index")},
          {"build_index_speed_vs_embree_morton", seconds.at("user_spheres low") / seconds.at("index")},
          {"build_copy_speed_vs_embree_morton", seconds.at("user_spheres low") / seconds.at("copy")},
          {"build_million_per_s", million_per_s("permute")},
          {"build_million_per_s_core", million_per_s("permute 1 thread")},
          {"nth_element_million_per_s_core", million_per_s("nth_element 1 thread")}};
}

}  // namespace bench
