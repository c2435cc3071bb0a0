#include "scene/embree_bridge.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "core/error.h"

namespace insitu {
namespace {

// Boxes grow by this part of the frame: far more than single precision loses on a ray that starts at its border.
constexpr double slack = 1e-5;

struct Query {
  RTCIntersectContext context;  // first: Embree hands its address back
  EmbreeBridge::Visit visit;
  void* state;
  double t_shift;  // of the ray's start in the frame
  double scale;    // world to frame
};

void box_bounds(const RTCBoundsFunctionArguments* arguments) {
  *arguments->bounds_o = *static_cast<const RTCBounds*>(arguments->geometryUserPtr);
}

void visit_box(const RTCIntersectFunctionNArguments* arguments) {
  if (arguments->valid[0] == 0) return;
  auto* query = reinterpret_cast<Query*>(arguments->context);
  auto* ray = reinterpret_cast<RTCRayHit*>(arguments->rayhit);
  const double limit = query->visit(query->state, arguments->geomID);
  const auto local = static_cast<float>(limit < 0.0 ? -1.0 : (limit - query->t_shift) * query->scale + slack);
  ray->ray.tfar = std::min(ray->ray.tfar, local);
}

}  // namespace

struct EmbreeBridge::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<RTCBounds> boxes;
  Bounds frame;
  double scale = 1.0;
};

// The device is left to its defaults: asking it for a number of threads would set TBB's process-wide limit.
EmbreeBridge::EmbreeBridge() : state_(new State) {
  state_->device = rtcNewDevice(nullptr);
  if (state_->device == nullptr) {
    delete state_;
    if (rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    throw Error(INSITU_ERROR_INTERNAL, "Embree could not be started");
  }
}

EmbreeBridge::~EmbreeBridge() {
  if (state_->scene != nullptr) rtcReleaseScene(state_->scene);
  rtcReleaseDevice(state_->device);
  delete state_;
}

void EmbreeBridge::build(const std::vector<Bounds>& boxes) {
  if (state_->scene != nullptr) rtcReleaseScene(state_->scene);
  state_->scene = rtcNewScene(state_->device);
  state_->frame = {};
  for (const Bounds& box : boxes) state_->frame.include(box);
  const glm::dvec3 centre = state_->frame.centre();
  const double diagonal = state_->frame.diagonal();
  state_->scale = diagonal > 0.0 ? 1.0 / diagonal : 1.0;

  state_->boxes.resize(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].empty()) continue;
    const glm::dvec3 lower = (boxes[i].lower - centre) * state_->scale - slack;
    const glm::dvec3 upper = (boxes[i].upper - centre) * state_->scale + slack;
    RTCBounds& bounds = state_->boxes[i];
    bounds.lower_x = static_cast<float>(lower.x);
    bounds.lower_y = static_cast<float>(lower.y);
    bounds.lower_z = static_cast<float>(lower.z);
    bounds.upper_x = static_cast<float>(upper.x);
    bounds.upper_y = static_cast<float>(upper.y);
    bounds.upper_z = static_cast<float>(upper.z);
    RTCGeometry geometry = rtcNewGeometry(state_->device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, 1);
    rtcSetGeometryUserData(geometry, &bounds);
    rtcSetGeometryBoundsFunction(geometry, box_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, visit_box);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(state_->scene, geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(state_->scene);
  const RTCError error = rtcGetDeviceError(state_->device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw Error(INSITU_ERROR_INTERNAL, "Embree could not build the scene");
}

void EmbreeBridge::trace(const kernels::Ray& ray, Visit visit, void* state) const {
  // The start is moved, in double, to where the ray enters the ball around the frame.
  const glm::dvec3 direction(ray.direction[0], ray.direction[1], ray.direction[2]);
  const glm::dvec3 from =
      (glm::dvec3(ray.origin[0], ray.origin[1], ray.origin[2]) - state_->frame.centre()) * state_->scale;
  const double nearest = -(from.x * direction.x + from.y * direction.y + from.z * direction.z);
  const double start = std::max(nearest - 1.0, ray.t_min * state_->scale);
  const glm::dvec3 at = from + start * direction;

  Query query;
  rtcInitIntersectContext(&query.context);
  query.visit = visit;
  query.state = state;
  query.scale = state_->scale;
  query.t_shift = start / state_->scale;
  RTCRayHit hit = {};
  hit.ray.org_x = static_cast<float>(at.x);
  hit.ray.org_y = static_cast<float>(at.y);
  hit.ray.org_z = static_cast<float>(at.z);
  hit.ray.dir_x = static_cast<float>(direction.x);
  hit.ray.dir_y = static_cast<float>(direction.y);
  hit.ray.dir_z = static_cast<float>(direction.z);
  hit.ray.tnear = 0.0f;
  hit.ray.tfar = static_cast<float>((ray.t_max - query.t_shift) * state_->scale + slack);
  hit.ray.mask = ~0u;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  if (!(hit.ray.tfar >= 0.0f)) return;
  rtcIntersect1(state_->scene, &query.context, &hit);
}

}  // namespace insitu
