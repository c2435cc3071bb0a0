// From insitu_particles_desc to checked views.
#pragma once

#include "geometry/particles/particles.h"
#include "insitu/insitu.h"

namespace insitu {

// Throws Error when the arrays cannot be used; the text names the array and what is wrong with it.
ParticleArrays read_particle_arrays(const insitu_particles_desc& desc, const std::string& set_name,
                                    ParticleOrder order);

// Throws Error(invalid_argument) for an unknown order.
ParticleOrder read_order(std::uint32_t order);

}  // namespace insitu
