// Tracing rays through a P-k-d tree. The best SIMD target of the machine is chosen at run time, once per call: hand
// over many rays at a time where there are many.
//
// Every function gives the same hits, to the last bit, as the brute force of pkd_reference.h: SIMD finds candidates in
// f32 with a margin that covers its rounding, and plain double arithmetic (sphere.h) decides.
#pragma once

#include <cstddef>
#include <vector>

#include "kernels/pkd_tree.h"

namespace insitu::kernels {

// hits[i] becomes the first hit of rays[i] with t_min < t <= t_max; a hit already in hits[i] is only replaced by a
// nearer one, so that several trees can be traced one after another.
void pkd_first_hits(const PkdTree& tree, const Ray* rays, Hit* hits, std::size_t count);

// occluded[i] becomes 1 when anything is hit with t_min < t <= t_max; rays with occluded[i] != 0 are left alone.
void pkd_any_hits(const PkdTree& tree, const Ray* rays, std::uint8_t* occluded, std::size_t count);

// Appends every item whose inside or surface the ray meets with t_min < t <= t_max, in no particular order.
void pkd_all_hits(const PkdTree& tree, const Ray& ray, std::vector<Span>& spans);

// Names of the compiled SIMD targets that this machine can run, best first, for tests that go through all of them.
std::vector<const char*> simd_target_names();
// Restricts dispatch to the target of that name; nullptr lifts the restriction. False for an unknown name. For tests
// and benchmarks only: it holds for the whole process.
bool force_simd_target(const char* name);

}  // namespace insitu::kernels
