// Random numbers against published values and against the distributions they promise.
#include "renderer/sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "unit/kernels/counter_random.h"

namespace insitu::testing {
namespace {

// kat_vectors of Random123, the authors' own implementation.
TEST(Philox, MatchesPublishedValues) {
  using Four = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Four{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t ones = 0xffffffff;
  EXPECT_EQ(philox({ones, ones, ones, ones}, {ones, ones}), (Four{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Four{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

// Pearson's statistic of counts that should all be equal.
double chi_square(const std::vector<std::uint64_t>& counts) {
  double sum = 0.0;
  for (const std::uint64_t count : counts) sum += static_cast<double>(count);
  const double expected = sum / static_cast<double>(counts.size());
  double statistic = 0.0;
  for (const std::uint64_t count : counts) {
    const double off = static_cast<double>(count) - expected;
    statistic += off * off / expected;
  }
  return statistic;
}

// Passed by all but one in 100,000 samples of the right distribution (Wilson and Hilferty's approximation).
double chi_square_limit(std::size_t bins) {
  const double k = static_cast<double>(bins - 1);
  const double part = 1.0 - 2.0 / (9.0 * k) + 4.265 * std::sqrt(2.0 / (9.0 * k));
  return k * part * part * part;
}

std::size_t bin_of(double value, std::size_t bins) {
  return std::min(bins - 1, static_cast<std::size_t>(value * static_cast<double>(bins)));
}

TEST(PixelNoise, IsEvenAndDiffersByPurposeAndSeed) {
  std::vector<std::uint64_t> counts(64, 0);
  std::size_t equal = 0;
  for (std::uint32_t y = 0; y < 256; ++y) {
    for (std::uint32_t x = 0; x < 256; ++x) {
      const glm::dvec2 u = pixel_noise(x, y, 1, 7);
      ASSERT_TRUE(u.x >= 0.0 && u.x < 1.0 && u.y >= 0.0 && u.y < 1.0);
      ++counts[8 * bin_of(u.x, 8) + bin_of(u.y, 8)];
      equal +=
          pixel_noise(x, y, 2, 7) == u || pixel_noise(x, y, 1, 8) == u || pixel_noise(y, x, 1, 7) == u ? x != y : 0;
    }
  }
  EXPECT_LT(chi_square(counts), chi_square_limit(64));
  EXPECT_EQ(equal, 0u);
}

// Under the cosine distribution the squared sine and the angle around the normal are both evenly spread.
TEST(CosineDirection, IsDistributedByTheCosine) {
  const glm::dvec3 normals[] = {{0, 0, 1},
                                {0, 0, -1},
                                {1, 0, 0},
                                {0, -1, 0},
                                glm::normalize(glm::dvec3(1, -2, 3)),
                                glm::normalize(glm::dvec3(1e-9, 0, -1))};
  CounterRandom random(1);
  for (const glm::dvec3& normal : normals) {
    const glm::dvec3 other = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 tangent = glm::normalize(glm::cross(normal, other));
    const glm::dvec3 bitangent = glm::cross(normal, tangent);
    std::vector<std::uint64_t> counts(10 * 12, 0);
    for (int i = 0; i < 100000; ++i) {
      const glm::dvec2 u(random.unit(), random.unit());
      const glm::dvec3 d = cosine_direction(normal, u);
      ASSERT_NEAR(glm::length(d), 1.0, 1e-14);
      const double cosine = glm::dot(d, normal);
      ASSERT_GE(cosine, -1e-15);
      const double angle = std::atan2(glm::dot(d, tangent), glm::dot(d, bitangent)) / (2.0 * std::numbers::pi) + 0.5;
      ++counts[12 * bin_of(std::max(0.0, 1.0 - cosine * cosine), 10) + bin_of(angle, 12)];
    }
    EXPECT_LT(chi_square(counts), chi_square_limit(120)) << normal.x << ' ' << normal.y << ' ' << normal.z;
  }
}

TEST(CosineDirection, TakesTheCornersOfTheSquare) {
  for (const double x : {0.0, 1.0 - 0x1p-53})
    for (const double y : {0.0, 1.0 - 0x1p-53}) {
      const glm::dvec3 d = cosine_direction({0, 0, 1}, {x, y});
      EXPECT_NEAR(glm::length(d), 1.0, 1e-14);
      EXPECT_GE(d.z, 0.0);
    }
}

TEST(R2Point, IsEvenlySpread) {
  EXPECT_EQ(r2_point(0), glm::dvec2(0.5, 0.5));
  for (const std::uint64_t n : {64u, 256u, 1024u}) {
    // Every axis-parallel box at the origin holds its share, up to the known discrepancy of the sequence.
    double worst = 0.0;
    for (int bx = 1; bx <= 16; ++bx) {
      for (int by = 1; by <= 16; ++by) {
        std::uint64_t inside = 0;
        for (std::uint64_t i = 0; i < n; ++i) {
          const glm::dvec2 p = r2_point(i);
          ASSERT_TRUE(p.x >= 0.0 && p.x < 1.0 && p.y >= 0.0 && p.y < 1.0);
          inside += p.x < bx / 16.0 && p.y < by / 16.0 ? 1 : 0;
        }
        worst = std::max(worst, std::abs(static_cast<double>(inside) / static_cast<double>(n) - bx * by / 256.0));
      }
    }
    EXPECT_LT(worst, 5.0 / static_cast<double>(n))
        << n << " points; random ones would be off by " << 0.5 / std::sqrt(static_cast<double>(n));
  }
  const glm::dvec2 late = r2_point(std::uint64_t{1} << 40);
  EXPECT_TRUE(late.x >= 0.0 && late.x < 1.0);
}

// What a (0, 2) sequence promises: of each aligned run of 2^k points there is one in each box of area 2^-k.
TEST(ScrambledPoint, FillsEveryElementaryBox) {
  for (std::uint32_t pixel = 0; pixel < 20; ++pixel) {
    for (int k = 0; k <= 8; ++k) {
      const std::uint32_t count = 1u << k;
      for (const std::uint32_t first : {0u, 3u * count}) {
        for (int columns = 0; columns <= k; ++columns) {
          std::vector<int> points(count, 0);
          for (std::uint32_t i = first; i < first + count; ++i) {
            const glm::dvec2 p = scrambled_point(i, pixel, 7, 1, 3);
            ASSERT_TRUE(p.x >= 0.0 && p.x < 1.0 && p.y >= 0.0 && p.y < 1.0);
            const auto column = static_cast<std::uint32_t>(p.x * (1u << columns));
            const auto row = static_cast<std::uint32_t>(p.y * (1u << (k - columns)));
            ++points[(row << columns) + column];
          }
          for (const int n : points) ASSERT_EQ(n, 1) << "pixel " << pixel << ", " << count << " points";
        }
      }
    }
  }
}

// Each point alone is anywhere: over many pixels all cells get their share, also those finer than the sequence.
TEST(ScrambledPoint, IsEvenOverPixels) {
  for (const std::uint32_t i : {0u, 1u, 2u, 5u, 1000u}) {
    std::vector<std::uint64_t> coarse(64, 0);
    std::vector<std::uint64_t> fine(64, 0);
    for (std::uint32_t y = 0; y < 200; ++y) {
      for (std::uint32_t x = 0; x < 200; ++x) {
        const glm::dvec2 p = scrambled_point(i, x, y, 2, 1);
        ++coarse[8 * bin_of(p.x, 8) + bin_of(p.y, 8)];
        ++fine[8 * bin_of(p.x * 128.0 - std::floor(p.x * 128.0), 8) + bin_of(p.y * 128.0 - std::floor(p.y * 128.0), 8)];
      }
    }
    EXPECT_LT(chi_square(coarse), chi_square_limit(64)) << i;
    EXPECT_LT(chi_square(fine), chi_square_limit(64)) << i;
  }
}

// Stripes of any period: the error is at most that of random points, by Owen's bound of a factor e of the variance.
TEST(ScrambledPoint, DoesNotFallIntoStepWithStripes) {
  constexpr std::uint32_t count = 64;
  for (double period = 2.0; period < 100.0; period *= 1.07) {
    double squares = 0.0;
    for (std::uint32_t pixel = 0; pixel < 400; ++pixel) {
      double lit = 0.0;
      for (std::uint32_t i = 0; i < count; ++i) {
        const double at = period * scrambled_point(i, pixel, 0, 2, 1).y;
        lit += at - std::floor(at) < 0.5 ? 1.0 / count : 0.0;
      }
      const double whole = std::floor(period);
      const double truth = (0.5 * whole + std::min(0.5, period - whole)) / period;
      squares += (lit - truth) * (lit - truth) / 400.0;
    }
    EXPECT_LT(squares, std::numbers::e * 0.25 / count * 1.3) << period;
  }
}

TEST(Shifted, WrapsAround) {
  EXPECT_EQ(shifted({0.25, 0.75}, {0.5, 0.5}), glm::dvec2(0.75, 0.25));
  const glm::dvec2 edge = shifted({1.0 - 0x1p-53, 0.5}, {1.0 - 0x1p-53, 0.5});
  EXPECT_LT(edge.x, 1.0);
  EXPECT_EQ(edge.y, 0.0);
}

}  // namespace
}  // namespace insitu::testing
