// Cameras: what insitu_camera describes, with the defaults filled in, and the rays through its pixels.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "insitu/insitu.h"

namespace insitu {

// World space bounds; lower > upper when empty.
struct Bounds {
  glm::dvec3 lower{1.0};
  glm::dvec3 upper{-1.0};
  bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  glm::dvec3 centre() const { return 0.5 * lower + 0.5 * upper; }
  double diagonal() const;
  void include(const Bounds& other);
};

struct Camera {
  std::uint32_t kind = INSITU_CAMERA_PERSPECTIVE;
  glm::dvec3 eye{0.0};
  glm::dvec3 look_at{0.0, 0.0, -1.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  double fov_y_deg = 35.0;
  double height = 0.0;  // orthographic; 0 = to be fitted
  double near_clip = 0.0;
  double far_clip = 0.0;  // 0 = none

  // Unit vectors, at right angles to each other.
  glm::dvec3 forward() const;
  glm::dvec3 right() const;
  glm::dvec3 true_up() const;
};

// Throws Error(invalid_argument) for non-finite numbers, angles outside of (0, 180) and the like.
Camera make_camera(const insitu_camera& description);
insitu_camera describe_camera(const Camera& camera);
// What a view without a camera starts from: from above, the right and the front.
Camera default_camera();

// Moves the camera along its direction so that `bounds` fill the image; keeps everything else. No change when empty.
void fit_camera(Camera& camera, const Bounds& bounds, double aspect);
// Turns the eye about the up axis through look_at.
void turn_camera(Camera& camera, double angle_deg);

// Rays through image positions: (0, 0) is the upper left corner of the image, (1, 1) the lower right one.
class CameraRays {
 public:
  CameraRays(const Camera& camera, double aspect);
  void ray(double x, double y, glm::dvec3& origin, glm::dvec3& direction) const;

 private:
  bool perspective_;
  glm::dvec3 eye_;
  glm::dvec3 corner_;  // of the image plane, relative to the eye
  glm::dvec3 across_;  // from the left to the right side of the image plane
  glm::dvec3 down_;    // from its top to its bottom
  glm::dvec3 forward_;
};

}  // namespace insitu
