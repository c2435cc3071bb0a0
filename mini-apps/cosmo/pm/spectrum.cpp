#include "spectrum.h"

#include <cmath>
#include <numbers>

#include "fourier.h"

namespace cosmo {

std::vector<PowerBin> measure_power(const Density& density, double side, Workers& workers) {
  const std::size_t nodes = density.nodes();
  Field field(nodes);
  const double per_mean = density.per_mean();
  workers.for_each(nodes, [&](std::size_t x) {
    for (std::size_t y = 0; y < nodes; ++y) {
      const std::uint64_t* const from = density.weights().data() + (x * nodes + y) * nodes;
      for (std::size_t z = 0; z < nodes; ++z) {
        field.row(x, y)[z] = static_cast<float>(static_cast<double>(from[z]) * per_mean - 1.0);
      }
    }
  });

  // One table per plane y of modes, added in order afterwards: the same sums for any number of threads.
  const std::size_t bins = nodes / 2;
  std::vector<std::vector<PowerBin>> planes(nodes, std::vector<PowerBin>(bins));
  const double lowest = 2.0 * std::numbers::pi / side;
  const auto cloud = [&](std::ptrdiff_t wave) {
    const double x = std::numbers::pi * static_cast<double>(wave) / static_cast<double>(nodes);
    const double sinc = wave == 0 ? 1.0 : std::sin(x) / x;
    return sinc * sinc;
  };
  Fourier(nodes).analyse(field, workers, [&](const Modes& modes) {
    const std::ptrdiff_t y = Fourier::wave_number(modes.y, nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
      const std::ptrdiff_t x = Fourier::wave_number(i, nodes);
      for (std::size_t c = 0; c < modes.count; ++c) {
        const auto z = static_cast<std::ptrdiff_t>(modes.z + c);
        const double wave = std::sqrt(static_cast<double>(x * x + y * y + z * z));
        const auto bin = static_cast<std::size_t>(std::lround(wave));
        if (bin == 0 || bin > bins) continue;
        // The half of the modes that is not stored has the same magnitudes.
        const std::uint64_t times = modes.z + c == 0 || modes.z + c == nodes / 2 ? 1 : 2;
        const double smoothing = cloud(x) * cloud(y) * cloud(z);
        PowerBin& b = planes[modes.y][bin - 1];
        b.k += static_cast<double>(times) * lowest * wave;
        b.power +=
            static_cast<double>(times) * static_cast<double>(std::norm(modes.at(i, c))) / (smoothing * smoothing);
        b.modes += times;
      }
    }
  });

  std::vector<PowerBin> result(bins);
  for (const std::vector<PowerBin>& plane : planes) {
    for (std::size_t b = 0; b < bins; ++b) {
      result[b].k += plane[b].k;
      result[b].power += plane[b].power;
      result[b].modes += plane[b].modes;
    }
  }
  const double cells = std::pow(static_cast<double>(nodes), 3.0);
  for (PowerBin& b : result) {
    b.k /= static_cast<double>(b.modes);
    b.power *= side * side * side / (cells * cells) / static_cast<double>(b.modes);
  }
  return result;
}

}  // namespace cosmo
