// Several geometries in one Embree scene. embree_bridge.cpp is the only file that includes Embree.
//
// Embree sees boxes alone, in single precision and in a frame of its own around the data; rays enter it where they
// enter that frame. Which geometry a ray really hits, and where, is left to the geometries and decided in double.
#pragma once

#include <vector>

#include "kernels/ray.h"
#include "scene/camera.h"

namespace insitu {

class EmbreeBridge {
 public:
  EmbreeBridge();  // throws Error(out_of_memory, internal)
  ~EmbreeBridge();
  EmbreeBridge(const EmbreeBridge&) = delete;
  EmbreeBridge& operator=(const EmbreeBridge&) = delete;

  void build(const std::vector<Bounds>& boxes);

  // Called for every box the ray may meet, near ones first as far as Embree can tell; returns the distance behind which
  // nothing is wanted any more, or a negative number to stop.
  using Visit = double (*)(void* state, std::uint32_t box);
  void trace(const kernels::Ray& ray, Visit visit, void* state) const;

 private:
  struct State;
  State* state_;
};

}  // namespace insitu
