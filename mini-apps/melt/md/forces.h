// Forces on all atoms, from records in any order.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "box.h"
#include "lennard_jones.h"
#include "neighbour_list.h"
#include "particle.h"
#include "workers.h"

namespace melt {

class Forces {
 public:
  Forces(const Box& box, const LennardJones& potential, double skin, std::size_t atoms);

  // Sums of the last compute(), over all pairs.
  struct Totals {
    double energy;
    double virial;  // sum of r . f
  };
  // Sets the force of every particle. When an atom has moved half a skin since the last list, all positions are
  // wrapped into the box and the list is built anew.
  Totals compute(std::span<Particle> particles, Workers& workers);

  // Records stand in another order than at the last compute(): look up again who is where. The lists stay as they are.
  void records_moved(std::span<const Particle> particles);

  // Place in the array of the atom in each slot. Sums over atoms along it do not depend on the order of the records.
  std::span<const std::uint32_t> places() const { return place_of_slot_; }
  std::uint64_t list_builds() const { return list_.builds(); }

 private:
  struct PairBuffer;
  struct Sum {
    Vec3 force;
    double energy;
    double virial;
  };
  Sum sum_over(std::size_t slot, PairBuffer& pairs) const;
  bool list_is_stale(Workers& workers) const;
  void gather(std::span<const Particle> particles, Workers& workers);
  void build_list(std::span<Particle> particles, Workers& workers);

  Box box_;
  LennardJones potential_;
  double skin_;
  NeighbourList list_;
  std::vector<std::uint32_t> place_of_id_;
  std::vector<std::uint32_t> place_of_slot_;
  std::vector<Vec3> points_;        // by slot: the positions packed 24 bytes apart, for the inner loop
  std::vector<Vec3> built_points_;  // by slot: where they were when the list was built
  std::vector<double> energy_;      // by slot: half of each of the atom's pair energies
  std::vector<double> virial_;      // by slot, likewise
};

}  // namespace melt
