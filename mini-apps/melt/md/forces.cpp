#include "forces.h"

#include <algorithm>
#include <atomic>

namespace melt {

// Pairs of one atom on their way through three short loops: choose those within the cutoff, without a branch that is
// mispredicted one time in three; evaluate the potential, which the compiler turns into SIMD; add up, in list order.
// 1.5 times as fast as one loop that does it all.
struct Forces::PairBuffer {
  static constexpr std::size_t size = 64;
  double x[size], y[size], z[size];  // difference of positions, then force
  double w[size];                    // squared distance, then virial
  double energy[size];
};

Forces::Forces(const Box& box, const LennardJones& potential, double skin, std::size_t atoms)
    : box_(box),
      potential_(potential),
      skin_(skin),
      list_(box, potential.cutoff() + skin, atoms),
      place_of_id_(atoms),
      place_of_slot_(atoms),
      points_(atoms),
      built_points_(atoms),
      energy_(atoms),
      virial_(atoms) {}

void Forces::records_moved(std::span<const Particle> particles) {
  for (std::size_t i = 0; i < particles.size(); ++i) {
    place_of_id_[static_cast<std::size_t>(particles[i].id)] = static_cast<std::uint32_t>(i);
  }
  const std::span<const std::uint32_t> ids = list_.ids();
  for (std::size_t slot = 0; slot < ids.size(); ++slot) place_of_slot_[slot] = place_of_id_[ids[slot]];
}

void Forces::gather(std::span<const Particle> particles, Workers& workers) {
  workers.for_each(points_.size(), [&](std::size_t slot) { points_[slot] = particles[place_of_slot_[slot]].position; });
}

bool Forces::list_is_stale(Workers& workers) const {
  // Two atoms that were farther apart than cutoff + skin may meet within the cutoff once each has moved half a skin.
  const double limit = 0.25 * skin_ * skin_;
  std::atomic<bool> stale = false;
  workers.for_each_block(points_.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double d2 = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double d = points_[i][k] - built_points_[i][k];
        d2 += d * d;
      }
      if (!(d2 < limit)) {  // also true for NaN
        stale = true;
        return;
      }
    }
  });
  return stale;
}

void Forces::build_list(std::span<Particle> particles, Workers& workers) {
  std::vector<Vec3> by_id(particles.size());
  workers.for_each(particles.size(), [&](std::size_t i) {
    Particle& p = particles[i];
    p.position = box_.wrapped(p.position);
    by_id[static_cast<std::size_t>(p.id)] = p.position;
  });
  list_.build(by_id, workers);
  records_moved(particles);
  gather(particles, workers);
  built_points_ = points_;
}

Forces::Sum Forces::sum_over(std::size_t slot, PairBuffer& pairs) const {
  const LennardJones potential = potential_;  // locals: the compiler keeps them in registers across the stores below
  const Box box = box_;
  const Vec3* const points = points_.data();
  const Vec3 p = points[slot];
  const std::span<const std::uint32_t> list = list_.of(slot);
  Sum sum{};
  for (std::size_t begin = 0; begin < list.size(); begin += PairBuffer::size) {
    const std::size_t end = std::min(list.size(), begin + PairBuffer::size);
    std::size_t count = 0;
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3& q = points[list[k]];
      const double dx = box.nearest(p[0] - q[0]);
      const double dy = box.nearest(p[1] - q[1]);
      const double dz = box.nearest(p[2] - q[2]);
      const double r2 = dx * dx + dy * dy + dz * dz;
      pairs.x[count] = dx;
      pairs.y[count] = dy;
      pairs.z[count] = dz;
      pairs.w[count] = r2;
      count += static_cast<std::size_t>(r2 < potential.cutoff_square());
    }
    for (std::size_t i = 0; i < count; ++i) {
      const LennardJones::Pair pair = potential(pairs.w[i]);
      pairs.x[i] *= pair.force_over_r;
      pairs.y[i] *= pair.force_over_r;
      pairs.z[i] *= pair.force_over_r;
      pairs.w[i] *= pair.force_over_r;
      pairs.energy[i] = pair.energy;
    }
    for (std::size_t i = 0; i < count; ++i) {
      sum.force[0] += pairs.x[i];
      sum.force[1] += pairs.y[i];
      sum.force[2] += pairs.z[i];
      sum.virial += pairs.w[i];
      sum.energy += pairs.energy[i];
    }
  }
  return sum;
}

Forces::Totals Forces::compute(std::span<Particle> particles, Workers& workers) {
  if (list_.builds() > 0) gather(particles, workers);
  if (list_.builds() == 0 || list_is_stale(workers)) build_list(particles, workers);

  workers.for_each_block(points_.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    PairBuffer pairs;
    for (std::size_t slot = begin; slot < end; ++slot) {
      const Sum sum = sum_over(slot, pairs);
      particles[place_of_slot_[slot]].force = sum.force;
      energy_[slot] = 0.5 * sum.energy;
      virial_[slot] = 0.5 * sum.virial;
    }
  });
  return {workers.sum(energy_.size(), [&](std::size_t i) { return energy_[i]; }),
          workers.sum(virial_.size(), [&](std::size_t i) { return virial_[i]; })};
}

}  // namespace melt
