// Tracing rays through the trees of paper_tree.h; the best SIMD target of the machine is chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "paper_tree.h"

namespace bench {

struct PaperView {
  const insitu::kernels::PkdTree& tree;
  const std::uint8_t* axes;
  TreeLayout layout;
  AxisRule rule;
  RayWay way;
};

void paper_first_hits(const PaperView& view, const insitu::kernels::Ray* rays, insitu::kernels::Hit* hits,
                      std::size_t count);
void paper_any_hits(const PaperView& view, const insitu::kernels::Ray* rays, std::uint8_t* occluded, std::size_t count);

// The library's kernels; `tree` is in order, with round robin axes.
void round_robin_first_hits(const insitu::kernels::PkdTree& tree, const insitu::kernels::Ray* rays,
                            insitu::kernels::Hit* hits, std::size_t count);
void round_robin_any_hits(const insitu::kernels::PkdTree& tree, const insitu::kernels::Ray* rays,
                          std::uint8_t* occluded, std::size_t count);

}  // namespace bench
