// The parallel, in-place build of a P-k-d tree (kernels/pkd_tree.h says what the tree is).
#pragma once

#include <vector>

#include "geometry/pkd/pkd_store.h"
#include "kernels/pkd_tree.h"

namespace insitu {

struct PkdBuilt {
  // reused: the particles were in tree order already. repaired: nearly so. The tree is as good in each case.
  enum class How : std::uint8_t { built, repaired, reused };
  How how = How::built;
  std::uint64_t moved = 0;  // exchanges and moves within blocks; a particle may be counted more than once
};

// Whether most particles stand where a tree would have them: found from a sample.
bool is_nearly_ordered(const kernels::PkdTree& tree);

// Each puts the particles at places [0, tree.count) into tree order, with as many threads as the caller's TBB arena
// has; the order does not depend on their number. `tree` is complete but for the order: position, count, box, radius,
// prefer. Scratch memory, whatever the number of particles: per thread 2 MB (6 MB for build_columns with several
// columns), and 12 MB at most for each range of more than 2^20 bytes of items that is being split. Particles that
// are nearly in order, as those of the step before may be, are repaired: what is in place stays there. Throw
// std::bad_alloc; what was moved by then is a permutation all the same.

// Repair::never is for comparisons.
enum class Repair : std::uint8_t { when_nearly_ordered, never };

// tree.index32 or tree.index64 is `index` and holds the items in any order.
PkdBuilt build_index(const kernels::PkdTree& tree, std::uint32_t* index, Repair repair = Repair::when_nearly_ordered);
PkdBuilt build_index(const kernels::PkdTree& tree, std::uint64_t* index, Repair repair = Repair::when_nearly_ordered);

// Everything in `columns` moves along; tree.position reads from them.
PkdBuilt build_columns(const kernels::PkdTree& tree, const std::vector<MovedColumn>& columns,
                       Repair repair = Repair::when_nearly_ordered);

}  // namespace insitu
