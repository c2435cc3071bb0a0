// Scenes of the golden images: small, readable layouts without random numbers, described once and drawn in many ways.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "insitu/insitu.h"

namespace insitu::golden {

constexpr std::uint32_t width = 128;
constexpr std::uint32_t height = 96;

// Particles with per-item radii. All numbers are exact in f32, so that f32 and f64 arrays hold the same scene.
struct Set {
  std::vector<double> x;  // x y z x y z ...
  std::vector<double> radius;
  std::vector<double> value;
  std::vector<std::int32_t> type;
  std::vector<double> vector;      // of the arrows
  const char* color_by = nullptr;  // "value", "type" or NULL: uniform
  const char* colormap = "viridis";
  std::vector<double> own_colors;  // categorical, sRGB and opacity: instead of `colormap`
  double color[3] = {0.8, 0.8, 0.8};
  double opacity = 0.0;  // as in insitu_style

  void add(double px, double py, double pz, double r, double v, std::int32_t t) {
    x.insert(x.end(), {px, py, pz});
    radius.push_back(r);
    value.push_back(v);
    type.push_back(t);
  }
  std::uint64_t count() const { return radius.size(); }
};

// What stands on the sets of a scene.
struct Glyphs {
  double bonds = 0.0;  // longest one; 0: none
  double bond_radius = 0.0;
  double arrows = 0.0;  // length over that of the vector; 0: none
  double arrow_radius = 0.0;
  insitu_cell cell = {};  // struct_size 0: none
  std::vector<insitu_filter_term> filter;
};

struct Scene {
  std::string name;
  Glyphs glyphs;
  std::vector<Set> sets;
  insitu_camera camera;
  std::vector<insitu_light> lights;  // empty: the default ones
  insitu_effects effects;
  double background[4] = {1.0, 1.0, 1.0, 1.0};
  std::uint32_t samples_per_pixel = 4;
};

std::vector<Scene> all_scenes();
// The one of that name; throws std::out_of_range.
Scene scene_named(const std::string& name);

// How a scene is handed over. None of this may show in the picture.
enum class Layout { records, columns, strided };
struct Variant {
  bool f32 = false;
  Layout layout = Layout::records;
  std::uint32_t order = INSITU_ORDER_INDEX;
  std::uint32_t threads = 1;
};
std::string name_of(const Variant& variant);

// Draws the scene through the C API. Returns the colour channel, 4 floats per pixel; with a `path` the picture is
// written there as well. Throws std::runtime_error with the library's own text.
std::vector<float> draw(const Scene& scene, const Variant& variant, const std::string& path = {});

}  // namespace insitu::golden
