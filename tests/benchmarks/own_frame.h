// A frame of particles of our own: camera rays, and an occlusion ray from every hit.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "measure.h"
#include "own_particles.h"
#include "ray_tiles.h"

namespace bench {

// Of a built set, for one view; borrows all that it is given.
class OwnFrame {
 public:
  OwnFrame(const OwnParticles& own, const std::vector<insitu::kernels::Ray>& camera, double ao_reach)
      : own_(own), camera_(camera), hits_(camera.size()) {
    own.set().first_hits(camera.data(), hits_.data(), camera.size());
    ao_ = occlusion_rays(camera, hits_, own.position, ao_reach);
    occluded_.resize(ao_.size());
  }

  std::size_t ao_rays() const { return ao_.size(); }
  Contender contender(const std::string& name, insitu::Workers& workers) {
    return {name, [this] { reset(); }, [this, &workers] { workers.run([this] { trace(); }); }};
  }

 private:
  void reset() {
    std::fill(hits_.begin(), hits_.end(), insitu::kernels::Hit{});
    std::fill(occluded_.begin(), occluded_.end(), std::uint8_t{0});
  }
  void trace() {
    for_tiles(camera_.size(),
              [this](std::size_t begin, std::size_t n) { own_.set().first_hits(&camera_[begin], &hits_[begin], n); });
    for_tiles(ao_.size(),
              [this](std::size_t begin, std::size_t n) { own_.set().any_hits(&ao_[begin], &occluded_[begin], n); });
  }

  const OwnParticles& own_;
  const std::vector<insitu::kernels::Ray>& camera_;
  std::vector<insitu::kernels::Hit> hits_;
  std::vector<insitu::kernels::Ray> ao_;
  std::vector<std::uint8_t> occluded_;
};

}  // namespace bench
