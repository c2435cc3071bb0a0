#include "golden_scene.h"

#include <cmath>
#include <stdexcept>

namespace insitu::golden {
namespace {

// To a multiple of 1/1024: exact in f32, and the same on every machine whatever its sine does in the last bit.
double rounded(double v) { return std::round(v * 1024.0) / 1024.0; }

struct Point {
  double x, y, z;
};

// Seen from `direction`, `distance` away from what is looked at.
Scene make_scene(const char* name, const Point& look_at, const Point& direction, double distance) {
  Scene scene;
  scene.name = name;
  insitu_camera_init(&scene.camera);
  insitu_effects_init(&scene.effects);
  const double length = std::sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
  const double at[3] = {look_at.x, look_at.y, look_at.z};
  const double from[3] = {direction.x, direction.y, direction.z};
  for (int c = 0; c < 3; ++c) {
    scene.camera.look_at[c] = at[c];
    scene.camera.eye[c] = rounded(at[c] + distance * from[c] / length);
  }
  scene.camera.fov_y_deg = 35.0;
  return scene;
}

insitu_light make_light(std::uint32_t kind, double x, double y, double z, double intensity) {
  insitu_light light;
  insitu_light_init(&light);
  light.kind = kind;
  light.direction[0] = x;
  light.direction[1] = y;
  light.direction[2] = z;
  light.intensity = intensity;
  return light;
}

// 6 x 5 x 4 balls, the value is their number.
Scene grid(const char* name, const char* colormap) {
  Scene scene = make_scene(name, {2.5, 2.0, 1.5}, {0.5, 0.375, 1.0}, 13.0);
  Set set;
  for (int i = 0; i < 120; ++i) set.add(i % 6, i / 6 % 5, i / 30, 0.375, i, i % 10);
  set.color_by = "value";
  set.colormap = colormap;
  scene.sets.push_back(set);
  return scene;
}

// Hexagons of carbon with hydrogen outside, a chain of water molecules beside them; radii near those of van der Waals.
Scene molecules() {
  Scene scene = make_scene("molecules", {3.0, -1.0, 0.5}, {0.25, 0.25, 1.0}, 21.0);
  Set set;
  constexpr double turn = 3.14159265358979323846 / 3.0;
  for (int ring = 0; ring < 2; ++ring) {
    for (int i = 0; i < 6; ++i) {
      const double c = std::cos(turn * i);
      const double s = std::sin(turn * i);
      set.add(rounded(6.0 * ring + 1.4 * c), rounded(1.4 * s), ring, 1.25, 0.0, 6);
      set.add(rounded(6.0 * ring + 2.5 * c), rounded(2.5 * s), ring, 0.75, 0.0, 1);
    }
  }
  for (int i = 0; i < 4; ++i) {
    const double x = -1.5 + 3.0 * i;
    set.add(x, -5.0, 0.5, 1.1875, 0.0, 8);
    set.add(x + 0.75, -5.5, 0.75, 0.75, 0.0, 1);
    set.add(x - 0.75, -5.5, 0.75, 0.75, 0.0, 1);
  }
  set.add(3.0, 3.0, 0.5, 1.25, 0.0, 7);
  set.add(3.0, -2.5, 0.5, 1.5, 0.0, 16);
  set.color_by = "type";
  set.colormap = "elements";
  scene.sets.push_back(set);
  return scene;
}

// Three spiral clusters of balls that shrink outwards, with ambient occlusion.
Scene clusters() {
  Scene scene = make_scene("clusters_ambient_occlusion", {2.75, 1.5, -0.25}, {0.0, 0.5, 1.0}, 21.0);
  Set set;
  constexpr double golden_angle = 2.39996322972865332;
  const double centre[3][3] = {{0, 0, 0}, {6, 1, -2}, {2.5, 4, 1}};
  for (const auto& at : centre) {
    for (int i = 0; i < 150; ++i) {
      const double r = 0.25 * std::sqrt(i);
      const double z = 1.5 * std::cos(0.4 * i) * (1.0 - i / 200.0);
      set.add(rounded(at[0] + r * std::cos(golden_angle * i)), rounded(at[1] + r * std::sin(golden_angle * i)),
              rounded(at[2] + z), rounded(0.4 - 0.0015 * i), rounded(std::sqrt(r * r + z * z)), 0);
    }
  }
  set.color_by = "value";
  set.colormap = "inferno";
  scene.sets.push_back(set);
  scene.effects.flags = INSITU_EFFECT_AMBIENT_OCCLUSION;
  scene.effects.ao_samples = 16;
  scene.effects.ao_radius = 2.0;
  return scene;
}

std::vector<double> four_colors() {
  return {0.85, 0.30, 0.25, 1.0, 0.25, 0.55, 0.85, 1.0, 0.95, 0.80, 0.30, 1.0, 0.35, 0.70, 0.40, 1.0};
}

// Balls that float above a ball as large as a floor; the light comes from the upper right.
Scene shadows() {
  Scene scene = make_scene("shadows", {0.0, 0.75, 0.0}, {3.0, 5.25, 11.0}, 12.5);
  Set set;
  set.add(0.0, -100.0, 0.0, 100.0, 0.0, 2);
  for (int i = 0; i < 9; ++i) set.add(2.0 * (i % 3) - 2.0, 0.75 + 0.25 * i, 2.0 * (i / 3) - 2.0, 0.5, i, i % 4);
  set.color_by = "type";
  set.own_colors = four_colors();
  scene.sets.push_back(set);
  scene.lights = {make_light(INSITU_LIGHT_AMBIENT, 0, 0, 0, 0.25),
                  make_light(INSITU_LIGHT_DIRECTIONAL, -0.5, -1.0, -0.25, 0.75)};
  scene.effects.flags = INSITU_EFFECT_SHADOWS;
  const double sky[4] = {0.4, 0.6, 0.9, 1.0};
  for (int c = 0; c < 4; ++c) scene.background[c] = sky[c];
  return scene;
}

// A staircase seen without perspective: all balls are equally large in the picture.
Scene orthographic() {
  Scene scene = make_scene("orthographic", {3.5, 1.75, -1.5}, {6.5, 6.25, 11.5}, 15.0);
  Set set;
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 4; ++k) set.add(i, 0.5 * i, -k, 0.4375, i, (i + k) % 4);
  set.color_by = "type";
  set.own_colors = four_colors();
  scene.sets.push_back(set);
  scene.camera.kind = INSITU_CAMERA_ORTHOGRAPHIC;
  scene.camera.height = 7.0;
  scene.lights = {make_light(INSITU_LIGHT_AMBIENT, 0, 0, 0, 0.375),
                  make_light(INSITU_LIGHT_DIRECTIONAL, -1.0, -2.0, 0.5, 0.5),
                  make_light(INSITU_LIGHT_DIRECTIONAL, 0.0, 0.0, -1.0, 0.125)};
  return scene;
}

// A torus of particles smaller than a pixel.
Scene dust() {
  Scene scene = make_scene("dust", {0.0, 0.0, 0.0}, {0.0, 0.75, 1.0}, 20.0);
  Set set;
  for (int i = 0; i < 1800; ++i) {
    const double a = 0.0034906585039886592 * i;  // once around
    const double b = 2.39996322972865332 * i;
    const double r = 4.0 + 1.5 * std::cos(b);
    set.add(rounded(r * std::cos(a)), rounded(1.5 * std::sin(b)), rounded(r * std::sin(a)), 0.03125, i, 0);
  }
  set.color_by = "value";
  set.colormap = "coolwarm";
  scene.sets.push_back(set);
  const double night[4] = {0.01, 0.01, 0.02, 1.0};
  for (int c = 0; c < 4; ++c) scene.background[c] = night[c];
  return scene;
}

// A shell of balls by one map around a core of another set, in one colour: two geometries that overlap.
Scene two_sets() {
  Scene scene = make_scene("two_sets", {-0.5, 0.0, 0.0}, {0.5, 0.375, 1.0}, 12.0);
  Set shell;
  for (int i = 0; i < 200; ++i) {
    const double y = 1.0 - 2.0 * (i + 0.5) / 200.0;
    const double r = std::sqrt(1.0 - y * y);
    const double a = 2.39996322972865332 * i;
    if (std::cos(a) * r > 0.25) continue;  // opened towards +x
    shell.add(rounded(3.0 * r * std::cos(a)), rounded(3.0 * y), rounded(3.0 * r * std::sin(a)), 0.25, rounded(y), 0);
  }
  shell.color_by = "value";
  shell.colormap = "coolwarm";
  Set core;
  for (int i = 0; i < 27; ++i) core.add(i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0, 0.75, 0.0, 0);
  core.color[0] = 0.2;
  core.color[1] = 0.5;
  core.color[2] = 0.2;
  scene.sets = {shell, core};
  scene.effects.flags = INSITU_EFFECT_SHADOWS;
  return scene;
}

insitu_cell make_cell(std::uint32_t flags, double a, double b, double c) {
  insitu_cell cell;
  insitu_cell_init(&cell);
  cell.flags = flags;
  cell.vectors[0][0] = a;
  cell.vectors[1][1] = b;
  cell.vectors[2][2] = c;
  return cell;
}

// Rings as balls and sticks, each half of a bond in the colour of its end, with shadows.
Scene ball_and_stick() {
  Scene scene = molecules();
  scene.name = "ball_and_stick";
  for (double& r : scene.sets[0].radius) r *= 0.3125;
  scene.glyphs.bonds = 1.5;
  scene.glyphs.bond_radius = 0.15625;
  scene.effects.flags = INSITU_EFFECT_SHADOWS;
  return scene;
}

// A whirl of arrows: small ones in the middle, which are all head.
Scene arrows() {
  Scene scene = make_scene("arrows", {0.0, 0.0, 0.0}, {0.25, 0.75, 1.0}, 11.0);
  Set set;
  for (int i = 0; i < 49; ++i) {
    const double x = i % 7 - 3;
    const double z = i / 7 - 3;
    set.add(x, 0.0, z, 0.0625, i, 0);
    set.vector.insert(set.vector.end(), {-z, 0.5 * x, x});
  }
  scene.sets.push_back(set);
  scene.glyphs.arrows = 0.25;
  scene.glyphs.arrow_radius = 0.046875;
  return scene;
}

// Six copies of a tilted cell, outlined; particles that have left it on one side come in on the other.
Scene replicas() {
  Scene scene = make_scene("replicas", {4.0, 2.0, 1.0}, {0.5, 0.625, 1.0}, 17.0);
  Set set;
  for (int i = 0; i < 24; ++i) {
    const int corner = i % 8;
    set.add(1.0 * (corner % 2) + 0.75 * (i / 8), 1.0 * (corner / 2 % 2) - 0.25 * (i / 8), 1.0 * (corner / 4) + 0.5,
            0.1875, 0.0, i / 8);
  }
  set.color_by = "type";
  set.own_colors = four_colors();
  scene.sets.push_back(set);
  scene.glyphs.cell = make_cell(INSITU_CELL_PERIODIC | INSITU_CELL_WRAP | INSITU_CELL_OUTLINE, 2.5, 2.25, 2.0);
  scene.glyphs.cell.vectors[1][0] = 0.5;
  scene.glyphs.cell.replicate[0] = 3;
  scene.glyphs.cell.replicate[1] = 2;
  scene.glyphs.cell.outline_radius = 0.03125;
  scene.glyphs.bonds = 0.9375;
  scene.glyphs.bond_radius = 0.078125;
  scene.effects.flags = INSITU_EFFECT_AMBIENT_OCCLUSION;
  scene.effects.ao_radius = 1.0;
  return scene;
}

// A lattice with bonds whose nearest corner is cut away, but for the balls around the middle: not in a box, or of a
// small value.
Scene filtered() {
  Scene scene = make_scene("filtered", {2.0, 1.875, 2.0}, {0.625, 0.5, 1.0}, 12.5);
  Set set;
  for (int i = 0; i < 125; ++i) {
    const int x = i % 5;
    const int y = i / 5 % 5;
    const int z = i / 25;
    set.add(x, y, z, 0.3125, (x - 2) * (x - 2) + (y - 2) * (y - 2) + (z - 2) * (z - 2), 0);
  }
  set.color_by = "value";
  set.colormap = "coolwarm";
  scene.sets.push_back(set);
  insitu_filter_term corner;
  insitu_filter_term_init(&corner);
  corner.kind = INSITU_FILTER_BOX;
  corner.flags = INSITU_FILTER_NOT;
  for (double& low : corner.lower) low = 2.0;
  for (double& high : corner.upper) high = 4.0;
  insitu_filter_term core;
  insitu_filter_term_init(&core);
  core.kind = INSITU_FILTER_RANGE;
  core.attribute = "value";
  core.range[1] = 1.0;
  core.alternative = 1;
  scene.glyphs.filter = {corner, core};
  scene.glyphs.bonds = 1.125;
  scene.glyphs.bond_radius = 0.09375;
  scene.effects.flags = INSITU_EFFECT_SHADOWS;
  return scene;
}

// A shell of bubbles, in four opacities, around opaque balls that cast their shadows on each other; a floor below.
Scene bubbles() {
  Scene scene = make_scene("bubbles", {0.0, 0.5, 0.0}, {3.0, 4.25, 11.0}, 13.0);
  Set shell;
  for (int i = 0; i < 70; ++i) {
    const double y = 1.0 - 2.0 * (i + 0.5) / 70.0;
    const double r = std::sqrt(1.0 - y * y);
    const double a = 2.39996322972865332 * i;
    shell.add(rounded(2.25 * r * std::cos(a)), rounded(2.25 * y + 0.5), rounded(2.25 * r * std::sin(a)), 0.625, i,
              i % 4);
  }
  shell.color_by = "type";
  shell.own_colors = four_colors();
  for (std::size_t i = 0; i < 4; ++i) shell.own_colors[4 * i + 3] = 0.125 + 0.25 * static_cast<double>(i);
  shell.opacity = 0.5;
  Set core;
  core.add(0.0, -102.75, 0.0, 100.0, 0.0, 2);
  for (int i = 0; i < 5; ++i) core.add(0.5 * i - 1.0, 0.25 * i, 0.5 - 0.375 * i, 0.5, i, i % 4);
  core.color_by = "type";
  core.own_colors = four_colors();
  scene.sets = {shell, core};
  scene.lights = {make_light(INSITU_LIGHT_AMBIENT, 0, 0, 0, 0.25),
                  make_light(INSITU_LIGHT_DIRECTIONAL, -0.5, -1.0, -0.25, 0.75)};
  scene.effects.flags = INSITU_EFFECT_SHADOWS;
  return scene;
}

Scene transparent_background() {
  Scene scene = grid("transparent_background", "categorical");
  scene.sets[0].color_by = "type";
  scene.background[3] = 0.0;
  scene.samples_per_pixel = 8;
  return scene;
}

}  // namespace

std::vector<Scene> all_scenes() {
  return {grid("grid_viridis", "viridis"),
          grid("grid_inferno", "inferno"),
          grid("grid_coolwarm", "coolwarm"),
          grid("grid_categorical", "categorical"),
          molecules(),
          clusters(),
          shadows(),
          orthographic(),
          dust(),
          two_sets(),
          ball_and_stick(),
          arrows(),
          replicas(),
          filtered(),
          bubbles(),
          transparent_background()};
}

Scene scene_named(const std::string& name) {
  for (const Scene& scene : all_scenes())
    if (scene.name == name) return scene;
  throw std::out_of_range("no scene '" + name + "'");
}

}  // namespace insitu::golden
