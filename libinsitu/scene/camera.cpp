#include "scene/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "core/error.h"

namespace insitu {
namespace {

constexpr double fit_margin = 1.04;  // a little air around the data

bool is_finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// Scaled first: components may be as small or large as doubles get.
glm::dvec3 unit(const glm::dvec3& v, const glm::dvec3& otherwise) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0.0)) return otherwise;
  return glm::normalize(v / largest);
}

double half_height(const Camera& camera) { return std::tan(0.5 * glm::radians(camera.fov_y_deg)); }

}  // namespace

double Bounds::diagonal() const { return empty() ? 0.0 : glm::length(upper - lower); }

void Bounds::include(const Bounds& other) {
  if (other.empty()) return;
  if (empty()) {
    *this = other;
    return;
  }
  for (int c = 0; c < 3; ++c) {
    lower[c] = std::min(lower[c], other.lower[c]);
    upper[c] = std::max(upper[c], other.upper[c]);
  }
}

glm::dvec3 Camera::forward() const { return unit(look_at - eye, {0.0, 0.0, -1.0}); }

glm::dvec3 Camera::right() const {
  const glm::dvec3 ahead = forward();
  const glm::dvec3 wanted = unit(up, {0.0, 1.0, 0.0});
  const glm::dvec3 side = glm::cross(ahead, wanted);
  if (glm::length(side) > 1e-9) return glm::normalize(side);
  // Looking along the up axis: another one.
  const glm::dvec3 other = std::abs(ahead.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0);
  return glm::normalize(glm::cross(ahead, other));
}

glm::dvec3 Camera::true_up() const { return glm::cross(right(), forward()); }

Camera make_camera(const insitu_camera& description) {
  const auto refuse = [](const char* text) {
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, std::string("camera: ") + text);
  };
  Camera camera;
  camera.kind = description.kind;
  if (camera.kind != INSITU_CAMERA_PERSPECTIVE && camera.kind != INSITU_CAMERA_ORTHOGRAPHIC)
    refuse("kind is neither INSITU_CAMERA_PERSPECTIVE nor INSITU_CAMERA_ORTHOGRAPHIC");
  camera.eye = {description.eye[0], description.eye[1], description.eye[2]};
  camera.look_at = {description.look_at[0], description.look_at[1], description.look_at[2]};
  camera.up = {description.up[0], description.up[1], description.up[2]};
  if (!is_finite(camera.eye) || !is_finite(camera.look_at) || !is_finite(camera.up))
    refuse("eye, look_at or up is not finite");
  if (camera.eye == camera.look_at) camera.look_at = camera.eye + glm::dvec3(0.0, 0.0, -1.0);
  if (camera.up == glm::dvec3(0.0)) camera.up = {0.0, 1.0, 0.0};
  if (description.fov_y_deg != 0.0) camera.fov_y_deg = description.fov_y_deg;
  if (!(camera.fov_y_deg > 0.0 && camera.fov_y_deg < 180.0)) refuse("fov_y_deg is not between 0 and 180");
  camera.height = description.height;
  if (!(camera.height >= 0.0 && std::isfinite(camera.height))) refuse("height is negative or not finite");
  camera.near_clip = description.near_clip;
  camera.far_clip = description.far_clip;
  if (!(camera.near_clip >= 0.0 && std::isfinite(camera.near_clip))) refuse("near_clip is negative or not finite");
  if (!(camera.far_clip >= 0.0) || (camera.far_clip != 0.0 && camera.far_clip <= camera.near_clip))
    refuse("far_clip is not beyond near_clip");
  return camera;
}

insitu_camera describe_camera(const Camera& camera) {
  insitu_camera description;
  insitu_camera_init(&description);
  description.kind = camera.kind;
  for (int c = 0; c < 3; ++c) {
    description.eye[c] = camera.eye[c];
    description.look_at[c] = camera.look_at[c];
    description.up[c] = camera.up[c];
  }
  description.fov_y_deg = camera.fov_y_deg;
  description.height = camera.height;
  description.near_clip = camera.near_clip;
  description.far_clip = camera.far_clip;
  return description;
}

Camera default_camera() {
  Camera camera;
  camera.eye = {0.6, 0.4, 1.0};
  camera.look_at = {0.0, 0.0, 0.0};
  return camera;
}

void fit_camera(Camera& camera, const Bounds& bounds, double aspect) {
  if (bounds.empty()) return;
  const glm::dvec3 ahead = camera.forward();
  const glm::dvec3 side = camera.right();
  const glm::dvec3 top = camera.true_up();
  const glm::dvec3 centre = bounds.centre();
  const double tan_y = half_height(camera);
  const double tan_x = tan_y * aspect;
  double distance = 0.0;
  double height = 0.0;
  double depth = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at((corner & 1) != 0 ? bounds.upper.x : bounds.lower.x,
                        (corner & 2) != 0 ? bounds.upper.y : bounds.lower.y,
                        (corner & 4) != 0 ? bounds.upper.z : bounds.lower.z);
    const glm::dvec3 offset = at - centre;
    const double x = std::abs(glm::dot(offset, side));
    const double y = std::abs(glm::dot(offset, top));
    const double z = glm::dot(offset, ahead);
    distance = std::max({distance, fit_margin * x / tan_x - z, fit_margin * y / tan_y - z, -fit_margin * z});
    height = std::max({height, 2.0 * y, 2.0 * x / aspect});
    depth = std::max(depth, std::abs(z));
  }
  camera.look_at = centre;
  if (camera.kind == INSITU_CAMERA_ORTHOGRAPHIC) {
    camera.height = height * fit_margin;
    camera.eye = centre - ahead * (depth + 0.5 * camera.height + camera.near_clip);
  } else {
    camera.eye = centre - ahead * distance;
  }
}

void turn_camera(Camera& camera, double angle_deg) {
  const glm::dvec3 axis = unit(camera.up, {0.0, 1.0, 0.0});
  const glm::dvec3 arm = camera.eye - camera.look_at;
  const double angle = glm::radians(angle_deg);
  // Rodrigues' rotation formula.
  const glm::dvec3 turned = arm * std::cos(angle) + glm::cross(axis, arm) * std::sin(angle) +
                            axis * (glm::dot(axis, arm) * (1.0 - std::cos(angle)));
  camera.eye = camera.look_at + turned;
}

CameraRays::CameraRays(const Camera& camera, double aspect)
    : perspective_(camera.kind == INSITU_CAMERA_PERSPECTIVE), eye_(camera.eye), forward_(camera.forward()) {
  const double height = perspective_ ? 2.0 * half_height(camera) : camera.height;
  across_ = camera.right() * (height * aspect);
  down_ = -camera.true_up() * height;
  corner_ = -0.5 * across_ - 0.5 * down_;
  if (perspective_) corner_ += forward_;
}

void CameraRays::ray(double x, double y, glm::dvec3& origin, glm::dvec3& direction) const {
  const glm::dvec3 on_plane = corner_ + x * across_ + y * down_;
  if (perspective_) {
    origin = eye_;
    direction = glm::normalize(on_plane);
  } else {
    origin = eye_ + on_plane;
    direction = forward_;
  }
}

}  // namespace insitu
