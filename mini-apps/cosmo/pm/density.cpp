#include "density.h"

#include <algorithm>
#include <atomic>

namespace cosmo {

void Density::deposit(std::span<const Vec3f> positions, Workers& workers) {
  particles_ = positions.size();
  const std::size_t plane = nodes_ * nodes_;
  workers.for_each(nodes_, [&](std::size_t x) {
    std::fill_n(weight_.begin() + static_cast<std::ptrdiff_t>(x * plane), plane, std::uint64_t{0});
  });
  workers.for_blocks(positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Clouds::Cloud c = clouds_.at(positions[i]);
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const bool up_x = corner >= 2;
        const bool up_y = corner % 2 == 1;
        const std::size_t row = ((up_x ? c.high[0] : c.low[0]) * nodes_ + (up_y ? c.high[1] : c.low[1])) * nodes_;
        const std::uint64_t share =
            std::uint64_t{up_x ? c.part[0] : Clouds::one - c.part[0]} * (up_y ? c.part[1] : Clouds::one - c.part[1]);
        const auto add = [&](std::size_t node, std::uint64_t weight) {
          std::atomic_ref(weight_[node]).fetch_add(weight, std::memory_order_relaxed);
        };
        add(row + c.low[2], share * (Clouds::one - c.part[2]));
        add(row + c.high[2], share * c.part[2]);
      }
    }
  });
}

double Density::per_mean() const {
  return static_cast<double>(weight_.size()) /
         (static_cast<double>(particles_) * static_cast<double>(Clouds::particle));
}

void Density::interpolate(std::span<const Vec3f> positions, std::span<float> out, Workers& workers) const {
  const double scale = per_mean();
  workers.for_blocks(positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Clouds::Cloud c = clouds_.at(positions[i]);
      double sum = 0.0;
      for (std::size_t corner = 0; corner < 8; ++corner) {
        std::size_t node = 0;
        double share = 1.0;
        for (std::size_t k = 0; k < 3; ++k) {
          const bool up = (corner >> k) % 2 == 1;
          node = node * nodes_ + (up ? c.high[k] : c.low[k]);
          share *= static_cast<double>(up ? c.part[k] : Clouds::one - c.part[k]) / Clouds::one;
        }
        sum += share * static_cast<double>(weight_[node]);
      }
      out[i] = static_cast<float>(sum * scale);
    }
  });
}

}  // namespace cosmo
