// The command line of insitu-replay.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "filter_text.h"
#include "reader.h"

namespace replay {

// What the user asked for cannot be done; the message says what could.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct CameraOptions {
  std::optional<std::array<double, 3>> eye;  // none: far enough away to see everything
  std::optional<std::array<double, 3>> at;
  std::optional<std::array<double, 3>> up;
  std::array<double, 3> from = {0, 0, 1};  // direction in which the camera stands as seen from the data
  double fov_deg = 0.0;
  double height = 0.0;
  bool orthographic = false;
  int turntable = 1;  // pictures of each step, all around
};

// Steps first, first + stride, ... below end; counted from 0 over all files.
struct StepSelection {
  std::uint64_t first = 0;
  std::optional<std::uint64_t> end;
  std::uint64_t stride = 1;

  bool contains(std::uint64_t step) const { return step >= first && !is_behind(step) && (step - first) % stride == 0; }
  bool is_behind(std::uint64_t step) const { return end && step >= *end; }
};

// Radii evenly spaced over the values from range[0] to range[1].
struct RadiusMap {
  std::array<double, 2> range;
  std::vector<double> radii;
};

struct Options {
  std::vector<std::string> files;
  ReadOptions read;
  std::vector<int> elements;  // atomic numbers of type 1, 2, ...; empty: as the file says
  StepSelection steps;
  bool list = false;
  bool quiet = false;

  std::string color;
  std::string colormap;
  std::optional<std::array<double, 2>> range;
  double opacity = 1.0;
  std::vector<double> opacity_map;  // evenly spaced over the colour map; empty: 1 everywhere
  std::string radius;
  std::optional<RadiusMap> radius_map;  // of the attribute that `radius` names
  double radius_scale = 1.0;
  std::vector<FilterChoice> filters;     // all of them have to hold
  double treelet_share = 0.0;            // of the bytes of the positions
  std::optional<double> bonds;           // the longest one; 0: by the radii of the elements
  std::optional<double> ball_and_stick;  // factor on the balls
  double stick_radius = 0.0;             // 0: by that of the largest particle
  std::string vectors;                   // the attribute
  double vector_scale = 0.0;             // 0: by the spacing
  bool cell = false;
  bool wrap = false;
  std::array<std::uint32_t, 3> replicate = {1, 1, 1};
  std::array<double, 4> background = {1, 1, 1, 1};  // linear

  CameraOptions camera;
  std::uint32_t ao_samples = 0;
  double ao_radius = 0.0;
  bool shadows = false;

  std::uint32_t width = 1024;
  std::uint32_t height = 768;
  std::uint32_t samples = 4;
  std::uint32_t max_samples = 0;  // 0: every pixel takes `samples`
  double pixel_error = 0.0;
  std::string out = "replay_{step}.png";
  std::string report;
  std::uint32_t threads = 0;
  std::uint32_t order = 0;  // INSITU_ORDER_*
};

// Throws UsageError. Empty when the program is done already, after --help or --version.
std::optional<Options> parse_options(int argc, char** argv);

}  // namespace replay
