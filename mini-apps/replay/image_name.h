// Names of image files from a pattern.
#pragma once

#include <cstdint>
#include <string>

namespace replay {

// Throws UsageError when the pattern has keys other than {step}, {step:N}, {angle} and {angle:N}, braces that are no
// key, or an ending other than .png and .exr.
void check_image_pattern(const std::string& pattern);

bool has_step(const std::string& pattern);
bool is_exr(const std::string& pattern);

// With {angle} added before the ending where it is missing, so that a turntable's pictures have different names.
std::string with_angle(const std::string& pattern);

// The name of the file for a step and an angle in degrees.
std::string image_name(const std::string& pattern, std::uint64_t step, double angle_deg);

}  // namespace replay
