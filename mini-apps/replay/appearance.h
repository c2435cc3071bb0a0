// How the particles of a frame look: what the options ask for, and what fits the data where they say nothing.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "frame.h"
#include "options.h"

namespace replay {

struct ColorChoice {
  std::string attribute;  // empty: one colour for all
  std::uint32_t component = 0;
  std::string colormap;
  std::array<double, 3> color = {0.8, 0.8, 0.8};  // linear
};

struct RadiusChoice {
  std::vector<float> per_particle;  // empty: one for all
  double for_all = 0.0;             // 0: left to the library
  std::string mapped;               // the attribute that goes through --radius-map; empty: none does
  std::uint32_t component = 0;      // of it
};

// "velocity", "velocity.x", "stress.4": the attribute and the component, counted from 1, or 0 where the text names
// none. nullptr when the frame does not have it.
const Attribute* find_component(const Frame& frame, const std::string& text, std::uint32_t& component);

// Both throw UsageError with the names that would be valid.
ColorChoice choose_color(const Frame& frame, const Options& options);
RadiusChoice choose_radius(const Frame& frame, const Options& options);

}  // namespace replay
