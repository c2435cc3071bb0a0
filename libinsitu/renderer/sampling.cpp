#include "renderer/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace insitu {
namespace {

std::uint32_t reversed(std::uint32_t v) {
  v = (v >> 1 & 0x55555555u) | (v & 0x55555555u) << 1;
  v = (v >> 2 & 0x33333333u) | (v & 0x33333333u) << 2;
  v = (v >> 4 & 0x0F0F0F0Fu) | (v & 0x0F0F0F0Fu) << 4;
  v = (v >> 8 & 0x00FF00FFu) | (v & 0x00FF00FFu) << 8;
  return v >> 16 | v << 16;
}

// A permutation in which a bit is flipped or not depending on the bits below it alone: Owen's scrambling of the
// reversed number. Laine and Karras, "Stratified sampling for stochastic transparency", EGSR 2011.
std::uint32_t scrambled(std::uint32_t v, std::uint32_t key) {
  v += key;
  for (const std::uint32_t even : {0x6C50B47Cu, 0xB82F1E52u, 0xC7AFE638u, 0x8D22F6E6u}) v ^= v * even;
  return v;
}

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  constexpr std::uint64_t multiplier_0 = 0xD2511F53;
  constexpr std::uint64_t multiplier_1 = 0xCD9E8D57;
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t product_0 = multiplier_0 * counter[0];
    const std::uint64_t product_1 = multiplier_1 * counter[2];
    counter = {static_cast<std::uint32_t>(product_1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(product_1),
               static_cast<std::uint32_t>(product_0 >> 32) ^ counter[3] ^ key[1],
               static_cast<std::uint32_t>(product_0)};
    key[0] += 0x9E3779B9;
    key[1] += 0xBB67AE85;
  }
  return counter;
}

glm::dvec2 pixel_noise(std::uint32_t x, std::uint32_t y, std::uint32_t purpose, std::uint32_t seed) {
  const std::array<std::uint32_t, 4> bits = philox({x, y, purpose, 0}, {seed, 0});
  constexpr double unit = 1.0 / 4294967296.0;
  return {bits[0] * unit, bits[1] * unit};
}

glm::dvec2 r2_point(std::uint64_t i) {
  constexpr double plastic = 1.32471795724474602596;  // the root of x^3 = x + 1
  constexpr glm::dvec2 step(1.0 / plastic, 1.0 / (plastic * plastic));
  const double n = static_cast<double>(i);
  const double x = 0.5 + n * step.x;
  const double y = 0.5 + n * step.y;
  return {x - std::floor(x), y - std::floor(y)};
}

glm::dvec2 scrambled_point(std::uint32_t i, std::uint32_t x, std::uint32_t y, std::uint32_t purpose,
                           std::uint32_t seed) {
  const std::array<std::uint32_t, 4> bits = philox({x, y, purpose, 0}, {seed, 0});
  // The first dimension is i with its bits reversed; those of the second follow from their matrix, which is Pascal's
  // triangle modulo 2.
  std::uint32_t second = 0;
  for (std::uint32_t rest = i, column = 0x80000000u; rest != 0; rest >>= 1, column ^= column >> 1)
    if ((rest & 1) != 0) second ^= column;
  constexpr double unit = 1.0 / 4294967296.0;
  return {reversed(scrambled(i, bits[0])) * unit, reversed(scrambled(reversed(second), bits[1])) * unit};
}

glm::dvec2 shifted(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 sum = a + b;
  return {sum.x >= 1.0 ? sum.x - 1.0 : sum.x, sum.y >= 1.0 ? sum.y - 1.0 : sum.y};
}

glm::dvec3 cosine_direction(const glm::dvec3& normal, const glm::dvec2& u) {
  // Malley's method: a point of the unit disc, lifted to the sphere.
  const double radius = std::sqrt(u.x);
  const double angle = 2.0 * std::numbers::pi * u.y;
  const double x = radius * std::cos(angle);
  const double y = radius * std::sin(angle);
  const double z = std::sqrt(std::max(0.0, 1.0 - u.x));
  // Duff et al., "Building an orthonormal basis, revisited", JCGT 6(1), 2017.
  const double sign = std::copysign(1.0, normal.z);
  const double a = -1.0 / (sign + normal.z);
  const double b = normal.x * normal.y * a;
  const glm::dvec3 tangent(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
  const glm::dvec3 bitangent(b, sign + normal.y * normal.y * a, -normal.y);
  return x * tangent + y * bitangent + z * normal;
}

}  // namespace insitu
