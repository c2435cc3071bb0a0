// Random numbers that are counted, not drawn: a number is a pure function of pixel, sample and seed, so that a picture
// does not depend on who computes which pixel when.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace insitu {

// Philox4x32-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011): counter and key to four
// independent 32-bit numbers.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

// Two numbers in [0, 1) for a pixel; `purpose` tells uses apart.
glm::dvec2 pixel_noise(std::uint32_t x, std::uint32_t y, std::uint32_t purpose, std::uint32_t seed);

// Point i of the R2 sequence (Roberts 2018), the two-dimensional relative of the golden ratio: evenly spread for every
// number of points. Point 0 is (1/2, 1/2).
glm::dvec2 r2_point(std::uint64_t i);

// a + b modulo 1: a sequence shifted by the noise of a pixel (Cranley and Patterson 1976).
glm::dvec2 shifted(const glm::dvec2& a, const glm::dvec2& b);

// Point i of a sequence of the pixel's own: the first two dimensions of Sobol (1967), scrambled as Owen (1995) has it.
// Every 2^k points beginning with a multiple of 2^k lie one in each of 2^k boxes of equal area, and within their box
// anywhere: regular structures, such as crystals along an axis, do not fall into step with them as with r2_point. The
// mean of n points is never much worse than that of n random ones, whatever the picture (Owen 1997: variance at most
// e = 2.72 times as large).
glm::dvec2 scrambled_point(std::uint32_t i, std::uint32_t x, std::uint32_t y, std::uint32_t purpose,
                           std::uint32_t seed);

// A direction about the unit vector `normal`, with a probability proportional to the cosine between them.
glm::dvec3 cosine_direction(const glm::dvec3& normal, const glm::dvec2& u);

}  // namespace insitu
