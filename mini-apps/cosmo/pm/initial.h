// The start: a Gaussian random field, and particles moved by it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "particles.h"
#include "power_spectrum.h"
#include "workers.h"

namespace cosmo {

// Displacements psi, in Mpc/h, of linear theory today, at the places of a lattice of `nodes`^3: -div psi is a Gaussian
// random field with the power spectrum given. White noise in real space, one random number per place, is coloured in
// Fourier space; so that the field depends on the seed and on nothing else.
std::vector<Vec3f> random_displacements(const PowerSpectrum& power, std::size_t nodes, double side, std::uint64_t seed,
                                        Workers& workers);

// Zel'dovich (A&A 5, 84 (1970)): x = q + D(a) psi(q), p = a^2 dx/dt. The lattice q stands half a mesh cell off the
// nodes of the mesh of forces, so that its clouds cover that mesh evenly, also if it has two nodes per particle.
void zeldovich_start(const Cosmology& cosmology, std::span<const Vec3f> displacements, std::size_t nodes, double side,
                     double offset, double a, Particles& particles, Workers& workers);

}  // namespace cosmo
