// The parallel, in-place build of a P-k-d tree (kernels/pkd_tree.h says what the tree is).
#pragma once

#include <vector>

#include "geometry/pkd/pkd_store.h"
#include "kernels/pkd_tree.h"

namespace insitu {

// Each puts the particles at places [0, tree.count) into tree order, with as many threads as the caller's TBB arena
// has; the order does not depend on their number. `tree` is complete but for the order: position, count, box, radius,
// prefer. Scratch memory, whatever the number of particles: per thread 2 MB (6 MB for build_columns with several
// columns), and 12 MB at most for each range of more than 2^20 bytes of items that is being split. Throw
// std::bad_alloc; what was moved by then is a permutation all the same.

// tree.index32 or tree.index64 is `index` and holds the items in any order.
void build_index(const kernels::PkdTree& tree, std::uint32_t* index);
void build_index(const kernels::PkdTree& tree, std::uint64_t* index);

// Everything in `columns` moves along; tree.position reads from them.
void build_columns(const kernels::PkdTree& tree, const std::vector<MovedColumn>& columns);

}  // namespace insitu
