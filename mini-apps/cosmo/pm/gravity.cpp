#include "gravity.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cosmo {

Gravity::Gravity(std::size_t nodes, double side, double omega_m, Workers& workers)
    : nodes_(nodes), side_(side), clouds_(nodes, side), fourier_(nodes), potential_(nodes) {
  tabulate(omega_m, workers);
}

// The influence function is that of the Laplacian as a difference over seven points, -h^2 / (4 sum sin^2(k_i h / 2))
// (Hockney & Eastwood, chapter 6; Klypin & Holtzman, astro-ph/9712217). For long waves it is -1/k^2; for shorter ones
// it is larger, by (kh)^2 / 12 along an axis, half of what the clouds of deposit and interpolation take away. Dividing
// by all of their smoothing instead makes forces between close particles depend on where between the nodes they are.
void Gravity::tabulate(double omega_m, Workers& workers) {
  const std::size_t half = nodes_ / 2 + 1;
  influence_.resize(half * half * half);
  const double h = side_ / static_cast<double>(nodes_);
  // The transform back is not normalised.
  const double scale = 1.5 * omega_m * h * h / std::pow(static_cast<double>(nodes_), 3.0);
  std::vector<double> sine(half);  // sin^2(kh / 2)
  for (std::size_t i = 0; i < half; ++i) {
    sine[i] = std::pow(std::sin(std::numbers::pi * static_cast<double>(i) / static_cast<double>(nodes_)), 2);
  }
  workers.for_each(half, [&](std::size_t x) {
    for (std::size_t y = 0; y < half; ++y) {
      for (std::size_t z = 0; z < half; ++z) {
        const double square = 4.0 * (sine[x] + sine[y] + sine[z]);
        // The mean pulls nobody: only the contrast counts.
        influence_[(x * half + y) * half + z] = square > 0.0 ? static_cast<float>(-scale / square) : 0.0f;
      }
    }
  });
}

void Gravity::solve(const Density& density, Workers& workers) {
  const double per_mean = density.per_mean();
  workers.for_each(nodes_, [&](std::size_t x) {
    for (std::size_t y = 0; y < nodes_; ++y) {
      const std::uint64_t* const from = density.weights().data() + (x * nodes_ + y) * nodes_;
      float* const to = potential_.row(x, y);
      for (std::size_t z = 0; z < nodes_; ++z) {
        to[z] = static_cast<float>(static_cast<double>(static_cast<std::int64_t>(from[z])) * per_mean - 1.0);
      }
    }
  });
  const std::size_t half = nodes_ / 2 + 1;
  fourier_.filter(potential_, workers, [&](const Modes& modes) {
    const std::size_t y = std::min(modes.y, nodes_ - modes.y);
    for (std::size_t x = 0; x < nodes_; ++x) {
      const float* const factor = &influence_[(std::min(x, nodes_ - x) * half + y) * half + modes.z];
      for (std::size_t c = 0; c < modes.count; ++c) modes.at(x, c) *= factor[c];
    }
  });
}

Vec3f Gravity::acceleration(const Vec3f& position) const {
  const Clouds::Cloud cloud = clouds_.at(position);
  // Along each axis: the six nodes that the differences at the two nodes of the cloud reach; the weights of these two;
  // and what the interpolated difference makes of the six.
  std::size_t node[3][6];
  float weight[3][2];
  float slope[3][6];
  constexpr float outer = 1.0f / 12.0f;
  constexpr float inner = 8.0f / 12.0f;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t low = cloud.low[k];
    const std::size_t high = cloud.high[k];
    const std::size_t last = nodes_ - 1;
    const auto before = [&](std::size_t i) { return i == 0 ? last : i - 1; };
    const auto after = [&](std::size_t i) { return i == last ? 0 : i + 1; };
    node[k][1] = before(low), node[k][0] = before(node[k][1]);
    node[k][2] = low, node[k][3] = high;
    node[k][4] = after(high), node[k][5] = after(node[k][4]);
    const float up = static_cast<float>(cloud.part[k]) * (1.0f / static_cast<float>(Clouds::one));
    const float down = 1.0f - up;
    weight[k][0] = down, weight[k][1] = up;
    slope[k][0] = outer * down;
    slope[k][1] = outer * up - inner * down;
    slope[k][2] = -inner * up;
    slope[k][3] = inner * down;
    slope[k][4] = inner * up - outer * down;
    slope[k][5] = -outer * up;
  }
  Vec3f gradient{};
  for (std::size_t i = 0; i < 6; ++i) {
    const bool core_x = i == 2 || i == 3;
    for (std::size_t j = 0; j < 6; ++j) {
      const bool core_y = j == 2 || j == 3;
      if (!core_x && !core_y) continue;
      const float* const row = potential_.row(node[0][i], node[1][j]);
      const float across = weight[2][0] * row[node[2][2]] + weight[2][1] * row[node[2][3]];
      if (core_y) gradient[0] += slope[0][i] * weight[1][j - 2] * across;
      if (core_x) gradient[1] += slope[1][j] * weight[0][i - 2] * across;
      if (core_x && core_y) {
        float along = 0.0f;
        for (std::size_t k = 0; k < 6; ++k) along += slope[2][k] * row[node[2][k]];
        gradient[2] += weight[0][i - 2] * weight[1][j - 2] * along;
      }
    }
  }
  const auto per_length = static_cast<float>(static_cast<double>(nodes_) / side_);
  return {-gradient[0] * per_length, -gradient[1] * per_length, -gradient[2] * per_length};
}

void Gravity::kick(std::span<const Vec3f> positions, std::span<Vec3f> momenta, double factor, Workers& workers) const {
  const auto f = static_cast<float>(factor);
  workers.for_blocks(positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f a = acceleration(positions[i]);
      for (std::size_t k = 0; k < 3; ++k) momenta[i][k] += f * a[k];
    }
  });
}

}  // namespace cosmo
