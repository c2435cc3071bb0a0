#include "embree_spheres.h"

#include <atomic>
#include <cmath>
#include <stdexcept>

#include "ray_tiles.h"

namespace bench {
namespace {

void sphere_bounds(const RTCBoundsFunctionArguments* a) {
  const float* s = static_cast<const float*>(a->geometryUserPtr) + 4 * std::size_t{a->primID};
  *a->bounds_o = {s[0] - s[3], s[1] - s[3], s[2] - s[3], 0.0f, s[0] + s[3], s[1] + s[3], s[2] + s[3], 0.0f};
}

// One sphere against the rays of a packet: plain code over lanes, which the compiler vectorizes.
template <bool occlusion>
inline void sphere_against(const float* s, unsigned n, const int* valid, RTCRayN* rays, RTCHitN* hits, unsigned geom,
                           unsigned prim) {
  for (unsigned i = 0; i < n; ++i) {
    if (valid[i] == 0) continue;
    const float dx = RTCRayN_dir_x(rays, n, i);
    const float dy = RTCRayN_dir_y(rays, n, i);
    const float dz = RTCRayN_dir_z(rays, n, i);
    const float mx = s[0] - RTCRayN_org_x(rays, n, i);
    const float my = s[1] - RTCRayN_org_y(rays, n, i);
    const float mz = s[2] - RTCRayN_org_z(rays, n, i);
    const float b = mx * dx + my * dy + mz * dz;
    const float px = mx - b * dx;
    const float py = my - b * dy;
    const float pz = mz - b * dz;
    const float d2 = px * px + py * py + pz * pz;
    const float r2 = s[3] * s[3];
    if (d2 > r2) continue;
    const float h = std::sqrt(r2 - d2);
    const float t0 = b - h;
    const float t1 = b + h;
    const float near = RTCRayN_tnear(rays, n, i);
    const float t = t0 > near ? t0 : t1;
    if (t <= near || t > RTCRayN_tfar(rays, n, i)) continue;
    if constexpr (occlusion) {
      RTCRayN_tfar(rays, n, i) = -std::numeric_limits<float>::infinity();
    } else {
      RTCRayN_tfar(rays, n, i) = t;
      RTCHitN_Ng_x(hits, n, i) = t * dx - mx;
      RTCHitN_Ng_y(hits, n, i) = t * dy - my;
      RTCHitN_Ng_z(hits, n, i) = t * dz - mz;
      RTCHitN_geomID(hits, n, i) = geom;
      RTCHitN_primID(hits, n, i) = prim;
    }
  }
}

template <unsigned n>
void intersect_lanes(const RTCIntersectFunctionNArguments* a) {
  const float* s = static_cast<const float*>(a->geometryUserPtr) + 4 * std::size_t{a->primID};
  sphere_against<false>(s, n, a->valid, RTCRayHitN_RayN(a->rayhit, n), RTCRayHitN_HitN(a->rayhit, n), a->geomID,
                        a->primID);
}

void intersect_spheres(const RTCIntersectFunctionNArguments* a) {
  // A constant number of lanes lets the compiler vectorize.
  switch (a->N) {
    case 1:
      return intersect_lanes<1>(a);
    case 8:
      return intersect_lanes<8>(a);
    case 16:
      return intersect_lanes<16>(a);
    default: {
      const float* s = static_cast<const float*>(a->geometryUserPtr) + 4 * std::size_t{a->primID};
      sphere_against<false>(s, a->N, a->valid, RTCRayHitN_RayN(a->rayhit, a->N), RTCRayHitN_HitN(a->rayhit, a->N),
                            a->geomID, a->primID);
    }
  }
}

template <unsigned n>
void occlude_lanes(const RTCOccludedFunctionNArguments* a) {
  const float* s = static_cast<const float*>(a->geometryUserPtr) + 4 * std::size_t{a->primID};
  sphere_against<true>(s, n, a->valid, a->ray, nullptr, a->geomID, a->primID);
}

void occlude_spheres(const RTCOccludedFunctionNArguments* a) {
  switch (a->N) {
    case 1:
      return occlude_lanes<1>(a);
    case 8:
      return occlude_lanes<8>(a);
    case 16:
      return occlude_lanes<16>(a);
    default: {
      const float* s = static_cast<const float*>(a->geometryUserPtr) + 4 * std::size_t{a->primID};
      sphere_against<true>(s, a->N, a->valid, a->ray, nullptr, a->geomID, a->primID);
    }
  }
}

// Secondary rays start this far from the sphere they leave, in single precision the usual remedy.
constexpr float secondary_start = 1e-5f;

template <class Ray>
void set_single(Ray& ray, const insitu::kernels::Ray& from) {
  ray.org_x = static_cast<float>(from.origin[0]);
  ray.org_y = static_cast<float>(from.origin[1]);
  ray.org_z = static_cast<float>(from.origin[2]);
  ray.dir_x = static_cast<float>(from.direction[0]);
  ray.dir_y = static_cast<float>(from.direction[1]);
  ray.dir_z = static_cast<float>(from.direction[2]);
  ray.tnear = from.exclude == insitu::kernels::no_item ? 0.0f : secondary_start;
  ray.tfar = static_cast<float>(from.t_max);
  ray.mask = ~0u;
}

alignas(64) constexpr int all_valid[16] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};

}  // namespace

const char* name_of(EmbreeGeometry geometry) {
  return geometry == EmbreeGeometry::sphere_point ? "sphere_point" : "user_spheres";
}

const char* name_of(EmbreeTrace trace) {
  switch (trace) {
    case EmbreeTrace::single:
      return "single";
    case EmbreeTrace::packet8:
      return "packet8";
    case EmbreeTrace::packet16:
      return "packet16";
    case EmbreeTrace::stream:
      return "stream";
  }
  return "";
}

const char* name_of(RTCBuildQuality quality) {
  return quality == RTC_BUILD_QUALITY_LOW ? "low" : quality == RTC_BUILD_QUALITY_HIGH ? "high" : "medium";
}

bool EmbreeSpheres::count_bytes(void* self, ssize_t bytes, bool) {
  std::atomic_ref<std::int64_t>(static_cast<EmbreeSpheres*>(self)->bytes_) += bytes;
  return true;
}

EmbreeSpheres::EmbreeSpheres(const ParticleScene& scene, EmbreeGeometry kind, RTCBuildQuality quality)
    : device_(rtcNewDevice(nullptr)) {
  rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, this);
  const std::size_t n = scene.count();
  spheres.resize(4 * n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < 3; ++c) spheres[4 * i + c] = scene.position[3 * i + c];
    spheres[4 * i + 3] = static_cast<float>(scene.radius);
  }
  scene_ = rtcNewScene(device_);
  rtcSetSceneBuildQuality(scene_, quality);
  if (kind == EmbreeGeometry::sphere_point) {
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, spheres.data(), 0, 16, n);
  } else {
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry_, static_cast<unsigned>(n));
    rtcSetGeometryUserData(geometry_, spheres.data());
    rtcSetGeometryBoundsFunction(geometry_, sphere_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry_, intersect_spheres);
    rtcSetGeometryOccludedFunction(geometry_, occlude_spheres);
  }
  rtcSetGeometryBuildQuality(geometry_, quality);
  bytes_ = 0;
}

EmbreeSpheres::~EmbreeSpheres() {
  rtcReleaseGeometry(geometry_);
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void EmbreeSpheres::build() {
  rtcCommitGeometry(geometry_);
  rtcAttachGeometry(scene_, geometry_);
  rtcCommitScene(scene_);
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw std::runtime_error("Embree could not build the scene");
}

EmbreeRays::EmbreeRays(const std::vector<insitu::kernels::Ray>& rays, EmbreeTrace trace)
    : trace_(trace), source_(rays) {
  switch (trace) {
    case EmbreeTrace::packet8:
      packets8_.resize((rays.size() + 7) / 8);
      break;
    case EmbreeTrace::packet16:
      packets16_.resize((rays.size() + 15) / 16);
      break;
    default:
      singles_.resize(rays.size());
  }
  reset();
}

template <class Packet>
void EmbreeRays::fill_packets(std::vector<Packet>& packets, std::size_t width) const {
  for (std::size_t i = 0; i < packets.size() * width; ++i) {
    Packet& packet = packets[i / width];
    const std::size_t lane = i % width;
    RTCRayHit one = {};
    set_single(one.ray, source_[std::min(i, source_.size() - 1)]);
    if (i >= source_.size()) one.ray.tfar = -1.0f;  // beyond the last ray
    packet.ray.org_x[lane] = one.ray.org_x;
    packet.ray.org_y[lane] = one.ray.org_y;
    packet.ray.org_z[lane] = one.ray.org_z;
    packet.ray.dir_x[lane] = one.ray.dir_x;
    packet.ray.dir_y[lane] = one.ray.dir_y;
    packet.ray.dir_z[lane] = one.ray.dir_z;
    packet.ray.tnear[lane] = one.ray.tnear;
    packet.ray.tfar[lane] = one.ray.tfar;
    packet.ray.time[lane] = 0.0f;
    packet.ray.mask[lane] = ~0u;
    packet.ray.id[lane] = 0;
    packet.ray.flags[lane] = 0;
    packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  }
}

void EmbreeRays::reset() {
  if (trace_ == EmbreeTrace::packet8) return fill_packets(packets8_, 8);
  if (trace_ == EmbreeTrace::packet16) return fill_packets(packets16_, 16);
  for (std::size_t i = 0; i < singles_.size(); ++i) {
    singles_[i] = {};
    set_single(singles_[i].ray, source_[i]);
    singles_[i].hit.geomID = RTC_INVALID_GEOMETRY_ID;
  }
}

void EmbreeRays::first_hits(RTCScene scene, bool coherent) {
  const auto flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  for_tiles(source_.size(), [&](std::size_t begin, std::size_t count) {
    const std::size_t end = begin + count;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = flags;
    switch (trace_) {
      case EmbreeTrace::single:
        for (std::size_t i = begin; i < end; ++i) rtcIntersect1(scene, &context, &singles_[i]);
        break;
      case EmbreeTrace::packet8:
        for (std::size_t i = begin; i < end; i += 8) rtcIntersect8(all_valid, scene, &context, &packets8_[i / 8]);
        break;
      case EmbreeTrace::packet16:
        for (std::size_t i = begin; i < end; i += 16) rtcIntersect16(all_valid, scene, &context, &packets16_[i / 16]);
        break;
      case EmbreeTrace::stream:
        rtcIntersect1M(scene, &context, &singles_[begin], static_cast<unsigned>(end - begin), sizeof(RTCRayHit));
        break;
    }
  });
}

void EmbreeRays::any_hits(RTCScene scene, bool coherent) {
  const auto flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  for_tiles(source_.size(), [&](std::size_t begin, std::size_t count) {
    const std::size_t end = begin + count;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = flags;
    switch (trace_) {
      case EmbreeTrace::single:
        for (std::size_t i = begin; i < end; ++i) rtcOccluded1(scene, &context, &singles_[i].ray);
        break;
      case EmbreeTrace::packet8:
        for (std::size_t i = begin; i < end; i += 8) rtcOccluded8(all_valid, scene, &context, &packets8_[i / 8].ray);
        break;
      case EmbreeTrace::packet16:
        for (std::size_t i = begin; i < end; i += 16)
          rtcOccluded16(all_valid, scene, &context, &packets16_[i / 16].ray);
        break;
      case EmbreeTrace::stream:
        rtcOccluded1M(scene, &context, &singles_[begin].ray, static_cast<unsigned>(end - begin), sizeof(RTCRayHit));
        break;
    }
  });
}

std::uint64_t EmbreeRays::count_hits() const {
  // Embree marks an occluded ray by tfar = -infinity; the lanes beyond the last ray have a finite negative one.
  const auto is_hit = [](unsigned geometry, float tfar) {
    return geometry != RTC_INVALID_GEOMETRY_ID || tfar == -std::numeric_limits<float>::infinity();
  };
  std::uint64_t count = 0;
  for (const RTCRayHit& one : singles_) count += is_hit(one.hit.geomID, one.ray.tfar) ? 1 : 0;
  const auto add = [&](const auto& packets, std::size_t width) {
    for (const auto& packet : packets)
      for (std::size_t lane = 0; lane < width; ++lane)
        count += is_hit(packet.hit.geomID[lane], packet.ray.tfar[lane]) ? 1 : 0;
  };
  add(packets8_, 8);
  add(packets16_, 16);
  return count;
}

}  // namespace bench
