// The one door to the simulation's memory: an insitu_array is checked here, and becomes a view that kernels read.
#pragma once

#include <string>
#include <vector>

#include "geometry/pkd/pkd_store.h"
#include "insitu/insitu.h"
#include "kernels/array_view.h"

namespace insitu {

struct ArrayVerdict {
  insitu_status status = INSITU_OK;
  std::string reason;  // one sentence, also when the array is fine
  std::uint64_t borrowed_bytes = 0;
};

// `use` is INSITU_USE_*, or use_payload.
constexpr std::uint32_t use_payload = 100;
ArrayVerdict judge_array(const insitu_array& array, std::uint32_t use);

// As judge_array, but throws Error; `what` names the array in the message. Rows that stand in one block at equal
// distances become records, which is what they are: they are read without the table, and a permutation sees which other
// arrays lie in the same records. It cannot see that of rows which stand anywhere.
kernels::ArrayView checked_view(const insitu_array& array, std::uint32_t use, const std::string& what);

// "f32", "u8", ...; "unknown".
const char* scalar_name(std::uint32_t type);

// The bytes of every item that a permutation has to move. Columns that lie within the records of another array of the
// same stride become one with it. Throws Error when arrays overlap in a way that cannot be permuted together.
class ColumnSet {
 public:
  void add(const kernels::ArrayView& view, const std::string& what);
  const std::vector<MovedColumn>& columns() const { return columns_; }
  void clear() { *this = ColumnSet(); }

 private:
  void add_column(MovedColumn column, std::uint64_t count, const std::string& what);

  std::vector<MovedColumn> columns_;
};

}  // namespace insitu
