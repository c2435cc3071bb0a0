// Texts of the command line that are more than a number or a name. All throw UsageError.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "options.h"

namespace replay {

// "eye=1,2,3,at=0,0,0,up=0,0,1,fov=40" or "fit".
void parse_camera(const std::string& text, CameraOptions& camera);
// "iso", "x", "-z", ... or "1,1,0.5": where the camera stands. Sets the direction upwards that goes with a name.
void parse_view(const std::string& text, CameraOptions& camera);
// "1920x1080".
std::pair<std::uint32_t, std::uint32_t> parse_size(const std::string& text);
// "A:B:K", where each part may be missing, or one number.
StepSelection parse_steps(const std::string& text);
// "2,2,1": how often the box is drawn along each of its edges.
std::array<std::uint32_t, 3> parse_replicate(const std::string& text);
// "auto", which is 0, or a length.
double parse_bonds(const std::string& text);
// "0:0,0.3:0.05,1:1": opacities at places of the colour map, as 1025 opacities evenly spaced over it.
std::vector<double> parse_opacity_map(const std::string& text);
// "0:0.1,2:0.5": radii at values of an attribute.
RadiusMap parse_radius_map(const std::string& text);
// "O,H,Na" as atomic numbers.
std::vector<int> parse_elements(const std::string& text);

// Linear RGB of "#rrggbb" or of a colour name; nothing for other texts.
std::optional<std::array<double, 3>> parse_color(const std::string& text);
// The same or "transparent", with opacity.
std::array<double, 4> parse_background(const std::string& text);

}  // namespace replay
