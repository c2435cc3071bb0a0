// The baselines: Embree's own spheres, and user geometry with one sphere per primitive, each traced with single rays,
// packets of 8 and 16 and streams.
#pragma once

#include <embree3/rtcore.h>

#include <string>
#include <vector>

#include "particle_scenes.h"

namespace bench {

enum class EmbreeGeometry { sphere_point, user_spheres };
enum class EmbreeTrace { single, packet8, packet16, stream };

const char* name_of(EmbreeGeometry geometry);
const char* name_of(EmbreeTrace trace);
const char* name_of(RTCBuildQuality quality);

class EmbreeSpheres {
 public:
  EmbreeSpheres(const ParticleScene& scene, EmbreeGeometry geometry, RTCBuildQuality quality);
  ~EmbreeSpheres();
  EmbreeSpheres(const EmbreeSpheres&) = delete;
  EmbreeSpheres& operator=(const EmbreeSpheres&) = delete;

  // The whole of what the host waits for: from the filled buffers to a scene that can be traced. Call once.
  void build();
  std::int64_t bytes() const { return bytes_; }

  RTCScene scene() const { return scene_; }

  std::vector<float> spheres;  // x y z radius, as SPHERE_POINT shares them

 private:
  static bool count_bytes(void* self, ssize_t bytes, bool post);
  RTCDevice device_;
  RTCScene scene_ = nullptr;
  RTCGeometry geometry_ = nullptr;
  std::int64_t bytes_ = 0;
};

// Rays in the form that a way of tracing wants. trace_* run in the caller's TBB arena, tile by tile.
class EmbreeRays {
 public:
  EmbreeRays(const std::vector<insitu::kernels::Ray>& rays, EmbreeTrace trace);
  void reset();  // undo what tracing wrote
  void first_hits(RTCScene scene, bool coherent);
  void any_hits(RTCScene scene, bool coherent);
  std::uint64_t count_hits() const;

 private:
  template <class Packet>
  void fill_packets(std::vector<Packet>& packets, std::size_t width) const;
  EmbreeTrace trace_;
  std::vector<insitu::kernels::Ray> source_;
  std::vector<RTCRayHit> singles_;
  std::vector<RTCRayHit8> packets8_;
  std::vector<RTCRayHit16> packets16_;
};

}  // namespace bench
