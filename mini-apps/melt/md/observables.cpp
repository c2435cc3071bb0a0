#include "observables.h"

#include <cmath>
#include <numbers>

namespace melt {

Vec3 total_momentum(std::span<const Particle> particles) {
  Vec3 sum{};
  for (const Particle& p : particles) {
    for (std::size_t k = 0; k < 3; ++k) sum[k] += p.velocity[k];
  }
  return sum;
}

double translational_order(std::span<const Particle> particles, const Box& box, std::uint64_t cells) {
  const double k = 2.0 * std::numbers::pi * static_cast<double>(cells) / box.side;
  double re = 0.0;
  double im = 0.0;
  for (const Particle& p : particles) {
    const double phase = k * (-p.position[0] + p.position[1] - p.position[2]);
    re += std::cos(phase);
    im += std::sin(phase);
  }
  return std::hypot(re, im) / static_cast<double>(particles.size());
}

RadialDistribution::RadialDistribution(double range, std::size_t bins)
    : width_(range / static_cast<double>(bins)), counts_(bins) {}

void RadialDistribution::add(std::span<const Particle> particles, const Box& box, std::size_t stride) {
  const double range = width_ * static_cast<double>(counts_.size());
  const double per_width = 1.0 / width_;
  double looked_from = 0.0;
  for (std::size_t i = 0; i < particles.size(); i += stride) {
    looked_from += 1.0;
    for (std::size_t j = 0; j < particles.size(); ++j) {
      double r2 = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double d = box.nearest(particles[i].position[k] - particles[j].position[k]);
        r2 += d * d;
      }
      if (r2 >= range * range || j == i) continue;
      const auto bin = static_cast<std::size_t>(std::sqrt(r2) * per_width);
      if (bin < counts_.size()) ++counts_[bin];
    }
  }
  centres_ += looked_from;
  pair_density_ += looked_from * static_cast<double>(particles.size()) / box.volume();
}

std::vector<double> RadialDistribution::values() const {
  std::vector<double> g(counts_.size());
  for (std::size_t i = 0; i < g.size(); ++i) {
    const double inner = width_ * static_cast<double>(i);
    const double outer = inner + width_;
    const double shell = 4.0 / 3.0 * std::numbers::pi * (outer * outer * outer - inner * inner * inner);
    g[i] = static_cast<double>(counts_[i]) / (pair_density_ * shell);
  }
  return g;
}

double RadialDistribution::neighbours(double from, double to) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (radius(i) >= from && radius(i) < to) sum += static_cast<double>(counts_[i]);
  }
  return sum / centres_;
}

}  // namespace melt
