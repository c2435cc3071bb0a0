// A set of particles of our own, with its arrays: what a host would hand over.
#pragma once

#include <malloc.h>

#include <memory>

#include "core/workers.h"
#include "geometry/particles/particles.h"
#include "particle_scenes.h"

namespace bench {

class OwnParticles {
 public:
  OwnParticles(const ParticleScene& scene, insitu::ParticleOrder order, double treelet_share)
      : position(scene.position), radius(scene.radii), value(scene.values), particles_("particles", order, false) {
    insitu::ParticleArrays arrays;
    arrays.position = view(position, 3);
    if (!radius.empty()) arrays.radius = view(radius, 1);
    if (!value.empty()) arrays.attributes.push_back({"value", view(value, 1)});
    arrays.radius_default = scene.radius;
    arrays.treelet_share = treelet_share;
    particles_.bind(arrays);
  }
  void build() { particles_.build(budget_); }
  // Draws only those particles; of a built tree no more than that is changed.
  void filter(std::shared_ptr<const insitu::Filter> filter) {
    particles_.set_filter(std::move(filter));
    if (particles_.is_built()) particles_.select(budget_);
  }
  const insitu::Particles& set() const { return particles_; }
  std::uint64_t data_bytes() const { return position.size() * sizeof(float); }

  std::vector<float> position;
  std::vector<float> radius;
  std::vector<float> value;

 private:
  static insitu::kernels::ArrayView view(const std::vector<float>& values, std::uint32_t components) {
    insitu::kernels::ArrayView view;
    view.type = insitu::kernels::Scalar::f32;
    view.components = components;
    view.count = values.size() / components;
    view.stride = static_cast<std::ptrdiff_t>(components * sizeof(float));
    for (std::uint32_t c = 0; c < components; ++c) view.base[c] = reinterpret_cast<const std::byte*>(values.data() + c);
    return view;
  }

  insitu::Budget budget_{0};
  insitu::Particles particles_;
};

// Bytes that malloc has handed out and not got back.
inline std::int64_t heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<std::int64_t>(info.uordblks + info.hblkhd);
}

// What a build leaves behind, per particle, as malloc sees it. The build before it leaves what TBB keeps for good.
inline double extra_bytes_per_particle(const ParticleScene& scene, insitu::ParticleOrder order, double treelet_share,
                                       insitu::Workers& workers) {
  std::int64_t extra = 0;
  for (int round = 0; round < 2; ++round) {
    OwnParticles own(scene, order, treelet_share);
    const std::int64_t before = heap_bytes();
    workers.run([&] { own.build(); });
    malloc_trim(0);
    extra = heap_bytes() - before;
  }
  return static_cast<double>(extra) / static_cast<double>(scene.count());
}

}  // namespace bench
