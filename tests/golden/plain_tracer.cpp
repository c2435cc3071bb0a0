#include "plain_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace insitu::golden {
namespace {

struct Vector {
  double x, y, z;
};
Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector operator*(double s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vector unit(const Vector& a) { return (1.0 / std::sqrt(dot(a, a))) * a; }
Vector vector_of(const double v[3]) { return {v[0], v[1], v[2]}; }

struct Ball {
  Vector centre;
  double radius;
  double color[3];  // linear
  double opacity;
};

std::vector<Ball> balls_of(const Scene& scene) {
  std::vector<Ball> balls;
  for (const Set& set : scene.sets) {
    for (std::size_t i = 0; i < set.count(); ++i) {
      Ball ball{vector_of(&set.x[3 * i]), set.radius[i], {}, set.opacity == 0.0 ? 1.0 : set.opacity};
      const std::size_t category = static_cast<std::size_t>(set.type[i]) % (set.own_colors.size() / 4);
      for (std::size_t c = 0; c < 3; ++c) {
        const double s = set.own_colors[4 * category + c];
        ball.color[c] = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
      }
      ball.opacity *= set.own_colors[4 * category + 3];
      balls.push_back(ball);
    }
  }
  return balls;
}

// The nearer root in front of the start, or infinity; school formula.
double meet(const Ball& ball, const Vector& origin, const Vector& direction) {
  const Vector f = origin - ball.centre;
  const double half_b = dot(f, direction);
  const double c = dot(f, f) - ball.radius * ball.radius;
  const double root = half_b * half_b - c;
  if (root < 0.0) return std::numeric_limits<double>::infinity();
  const double t = -half_b - std::sqrt(root);
  return t > 0.0 ? t : std::numeric_limits<double>::infinity();
}

// Where less than this is left, nothing is.
constexpr double least = 1.0 / 1024;

struct Layer {
  double t;
  const Ball* ball;
};

std::vector<Layer> layers_of(const std::vector<Ball>& balls, const Vector& origin, const Vector& direction) {
  std::vector<Layer> layers;
  for (const Ball& ball : balls) {
    const double t = meet(ball, origin, direction);
    if (t < std::numeric_limits<double>::infinity()) layers.push_back({t, &ball});
  }
  std::stable_sort(layers.begin(), layers.end(), [](const Layer& a, const Layer& b) { return a.t < b.t; });
  return layers;
}

double light_at(const Scene& scene, const std::vector<Ball>& balls, const Ball& on, const Vector& point) {
  const bool has_shadows = (scene.effects.flags & INSITU_EFFECT_SHADOWS) != 0;
  double light = 0.0;
  for (const insitu_light& lamp : scene.lights) {
    if (lamp.kind == INSITU_LIGHT_AMBIENT) {
      light += lamp.intensity;
      continue;
    }
    const Vector towards = unit(-1.0 * vector_of(lamp.direction));
    const double cosine = dot(unit(point - on.centre), towards);
    if (!(cosine > 0.0)) continue;
    double passed = 1.0;
    for (const Ball& ball : balls) {
      const bool in_the_way =
          has_shadows && &ball != &on && meet(ball, point, towards) < std::numeric_limits<double>::infinity();
      if (in_the_way) passed *= 1.0 - ball.opacity;
    }
    if (passed >= least) light += passed * lamp.intensity * cosine;
  }
  return light;
}

}  // namespace

std::vector<float> trace_plainly(const Scene& scene) {
  const std::vector<Ball> balls = balls_of(scene);
  const insitu_camera& camera = scene.camera;
  const Vector eye = vector_of(camera.eye);
  const Vector ahead = unit(vector_of(camera.look_at) - eye);
  const Vector side = unit(cross(ahead, {0.0, 1.0, 0.0}));
  const Vector top = cross(side, ahead);
  const bool perspective = camera.kind == INSITU_CAMERA_PERSPECTIVE;
  constexpr double pi = 3.14159265358979323846;
  const double half_height = perspective ? std::tan(camera.fov_y_deg * pi / 360.0) : 0.5 * camera.height;

  std::vector<float> pixels;
  for (std::uint32_t py = 0; py < height; ++py) {
    for (std::uint32_t px = 0; px < width; ++px) {
      double sum[3] = {};
      for (std::uint32_t k = 0; k < scene.samples_per_pixel; ++k) {
        // Samples stand at the points of the R2 sequence within the pixel.
        const double plastic = 1.32471795724474602596;
        double whole;
        const double sx = std::modf(0.5 + k / plastic, &whole);
        const double sy = std::modf(0.5 + k / (plastic * plastic), &whole);
        const double right = half_height * (2.0 * (px + sx) / width - 1.0) * width / height;
        const double up = half_height * (1.0 - 2.0 * (py + sy) / height);
        const Vector across = right * side + up * top;
        const Vector origin = perspective ? eye : eye + across;
        const Vector direction = perspective ? unit(ahead + across) : ahead;

        double left = 1.0;  // of the light from behind
        for (const Layer& layer : layers_of(balls, origin, direction)) {
          const Vector point = origin + layer.t * direction;
          double passed = left * (1.0 - layer.ball->opacity);
          if (passed < least) passed = 0.0;
          const double light = light_at(scene, balls, *layer.ball, point);
          for (int c = 0; c < 3; ++c) sum[c] += (left - passed) * layer.ball->color[c] * light;
          left = passed;
        }
        for (int c = 0; c < 3; ++c) sum[c] += left * scene.background[c];
      }
      for (const double s : sum) pixels.push_back(static_cast<float>(s / scene.samples_per_pixel));
      pixels.push_back(1.0f);
    }
  }
  return pixels;
}

}  // namespace insitu::golden
