#include "geometry/array_view.h"

#include <algorithm>
#include <optional>

#include "core/error.h"

namespace insitu {
namespace {

using kernels::ArrayView;
using kernels::Scalar;

std::optional<Scalar> scalar_of(std::uint32_t type) {
  switch (type) {
    case INSITU_F32:
      return Scalar::f32;
    case INSITU_F64:
      return Scalar::f64;
    case INSITU_I32:
      return Scalar::i32;
    case INSITU_I64:
      return Scalar::i64;
    case INSITU_U8:
      return Scalar::u8;
    case INSITU_U32:
      return Scalar::u32;
    case INSITU_U64:
      return Scalar::u64;
    default:
      return std::nullopt;
  }
}

ArrayVerdict refuse(insitu_status status, std::string reason) { return {status, std::move(reason), 0}; }

struct UseRule {
  const char* name;
  std::uint32_t components_min;
  std::uint32_t components_max;
  bool floats;
  bool integers;
};

std::optional<UseRule> rule_of(std::uint32_t use) {
  switch (use) {
    case INSITU_USE_POSITION:
      return UseRule{"positions", 3, 3, true, true};
    case INSITU_USE_RADIUS:
      return UseRule{"radii", 1, 1, true, false};
    case INSITU_USE_TYPE:
      return UseRule{"types", 1, 1, false, true};
    case INSITU_USE_ATTRIBUTE:
      return UseRule{"an attribute", 1, 4, true, true};
    case INSITU_USE_PAIRS:
      return UseRule{"pairs", 2, 2, false, true};
    case use_payload:
      return UseRule{"payload", 1, 4, true, true};
    default:
      return std::nullopt;
  }
}

bool is_float(Scalar type) { return type == Scalar::f32 || type == Scalar::f64; }

std::string number(std::int64_t value) { return std::to_string(value); }

std::uintptr_t row_address(const insitu_array& array, std::ptrdiff_t table_stride, std::uint64_t item) {
  const auto* table = static_cast<const std::byte*>(array.component[0]);
  return kernels::load<std::uintptr_t>(table + static_cast<std::ptrdiff_t>(item) * table_stride);
}

// Every row pointer is looked at: one that is NULL would end the host.
std::optional<std::string> find_bad_row(const insitu_array& array, std::ptrdiff_t table_stride, std::size_t alignment) {
  for (std::uint64_t item = 0; item < array.count; ++item) {
    const std::uintptr_t row = row_address(array, table_stride, item);
    if (row == 0) return "row pointer " + std::to_string(item) + " is NULL";
    if (row % alignment != 0)
      return "row pointer " + std::to_string(item) + " is not aligned to " + std::to_string(alignment) + " bytes";
  }
  return std::nullopt;
}

// The distance of rows that stand in one block at equal distances, as most codes allocate them: such rows are records.
std::optional<std::ptrdiff_t> distance_of_rows(const insitu_array& array, std::ptrdiff_t table_stride,
                                               std::ptrdiff_t scalar_bytes) {
  const std::ptrdiff_t row_bytes = scalar_bytes * static_cast<std::ptrdiff_t>(array.components);
  if (array.count < 2) return row_bytes;
  const std::uintptr_t first = row_address(array, table_stride, 0);
  const std::uintptr_t distance = row_address(array, table_stride, 1) - first;  // modulo 2^64: rows may go backwards
  for (std::uint64_t item = 2; item < array.count; ++item)
    if (row_address(array, table_stride, item) != first + item * distance) return std::nullopt;
  const auto stride = static_cast<std::ptrdiff_t>(distance);
  if (std::abs(stride) < row_bytes) return std::nullopt;
  return stride;
}

// The layout alone: whatever the array is used for.
ArrayVerdict judge_layout(const insitu_array& array, Scalar type) {
  const auto size = static_cast<std::int64_t>(kernels::size_of(type));
  const bool rows = (array.flags & INSITU_ARRAY_ROWS) != 0;
  if (array.count == 0) return {INSITU_OK, "empty: nothing is read", 0};
  if (array.component[0] == nullptr)
    return refuse(INSITU_ERROR_INVALID_ARGUMENT, "component[0] is NULL but count is not 0");
  std::uint32_t columns = 0;
  for (std::uint32_t c = 1; c < std::min<std::uint32_t>(array.components, 4); ++c)
    columns += array.component[c] != nullptr ? 1 : 0;
  if (columns != 0 && columns + 1 != array.components)
    return refuse(INSITU_ERROR_INVALID_ARGUMENT, "either all component pointers are set, or only component[0]");
  if (rows && columns != 0)
    return refuse(INSITU_ERROR_INVALID_ARGUMENT, "an array of rows has only component[0], the table of row pointers");

  const std::int64_t unit = rows ? static_cast<std::int64_t>(sizeof(void*)) : size;
  const std::int64_t packed = rows ? unit : columns != 0 ? size : size * array.components;
  const std::int64_t stride = array.stride_bytes == 0 ? packed : array.stride_bytes;
  if (stride % unit != 0)
    return refuse(INSITU_ERROR_INVALID_ARGUMENT, "stride_bytes " + number(stride) + " is no multiple of the scalar's " +
                                                     number(unit) + " bytes: items would be misaligned");
  // The magnitude of the smallest stride there is has no signed counterpart.
  const std::uint64_t span = stride < 0 ? ~static_cast<std::uint64_t>(stride) + 1 : static_cast<std::uint64_t>(stride);
  if (span < static_cast<std::uint64_t>(packed) && array.count > 1)
    return refuse(INSITU_ERROR_INVALID_ARGUMENT, "stride_bytes " + number(stride) + " is shorter than an item's " +
                                                     number(packed) + " bytes: items would overlap");
  const std::uint64_t limit = (std::uint64_t{1} << 62) / span;
  if (array.count > limit)
    return refuse(INSITU_ERROR_INVALID_ARGUMENT,
                  "count " + std::to_string(array.count) + " times the stride is more than any memory");
  for (std::uint32_t c = 0; c <= columns; ++c)
    if (reinterpret_cast<std::uintptr_t>(array.component[c]) % static_cast<std::uintptr_t>(unit) != 0)
      return refuse(INSITU_ERROR_INVALID_ARGUMENT,
                    "component[" + std::to_string(c) + "] is not aligned to " + number(unit) + " bytes");
  if (rows) {
    const std::optional<std::string> bad = find_bad_row(array, stride, static_cast<std::size_t>(size));
    if (bad) return refuse(INSITU_ERROR_INVALID_ARGUMENT, *bad);
  }
  const char* layout = rows               ? "rows"
                       : columns != 0     ? "columns"
                       : stride == packed ? "packed records"
                                          : "strided records";
  return {INSITU_OK, std::string("borrowed: ") + layout + " of " + scalar_name(array.type) + " are read in place",
          array.count * static_cast<std::uint64_t>(size) * array.components};
}

}  // namespace

const char* scalar_name(std::uint32_t type) {
  constexpr const char* names[] = {"unknown", "f32", "f64", "i32", "i64", "u8", "u32", "u64"};
  return type < std::size(names) ? names[type] : names[0];
}

ArrayVerdict judge_array(const insitu_array& array, std::uint32_t use) {
  const std::optional<UseRule> rule = rule_of(use);
  if (!rule) return refuse(INSITU_ERROR_INVALID_ARGUMENT, "unknown use " + std::to_string(use));
  const std::optional<Scalar> type = scalar_of(array.type);
  if (!type) return refuse(INSITU_ERROR_INVALID_ARGUMENT, "unknown scalar type " + std::to_string(array.type));
  constexpr std::uint32_t known = INSITU_ARRAY_PERMUTABLE | INSITU_ARRAY_SAME_VALUES | INSITU_ARRAY_ROWS;
  if ((array.flags & ~known) != 0) return refuse(INSITU_ERROR_INVALID_ARGUMENT, "unknown array flags");
  // Whole records of any length may travel as bytes.
  const bool bytes = use == use_payload && *type == Scalar::u8;
  if (array.components < rule->components_min || (array.components > rule->components_max && !bytes))
    return refuse(INSITU_ERROR_INVALID_ARGUMENT,
                  std::string(rule->name) + " need " + std::to_string(rule->components_min) + " to " +
                      std::to_string(rule->components_max) + " components, not " + std::to_string(array.components));
  if ((is_float(*type) && !rule->floats) || (!is_float(*type) && !rule->integers))
    return refuse(INSITU_ERROR_UNSUPPORTED,
                  std::string(rule->name) + " cannot be " + scalar_name(array.type) + " here");
  if (use == INSITU_USE_POSITION && *type != Scalar::f32 && *type != Scalar::f64 && *type != Scalar::i32 &&
      *type != Scalar::u32)
    return refuse(INSITU_ERROR_UNSUPPORTED,
                  std::string("positions are f32, f64, i32 or u32, not ") + scalar_name(array.type));
  if (use == INSITU_USE_PAIRS && *type == Scalar::u8)
    return refuse(INSITU_ERROR_UNSUPPORTED, "pairs are i32, i64, u32 or u64, not u8");
  return judge_layout(array, *type);
}

ArrayView checked_view(const insitu_array& array, std::uint32_t use, const std::string& what) {
  const ArrayVerdict verdict = judge_array(array, use);
  if (verdict.status != INSITU_OK) throw Error(verdict.status, what + ": " + verdict.reason);
  ArrayView view;
  view.type = *scalar_of(array.type);
  view.count = array.count;
  view.components = array.components;
  view.rows = (array.flags & INSITU_ARRAY_ROWS) != 0;
  const auto size = static_cast<std::ptrdiff_t>(kernels::size_of(view.type));
  const bool columns = array.components > 1 && array.component[1] != nullptr;
  view.stride = array.stride_bytes != 0 ? static_cast<std::ptrdiff_t>(array.stride_bytes)
                : view.rows             ? static_cast<std::ptrdiff_t>(sizeof(void*))
                : columns               ? size
                                        : size * static_cast<std::ptrdiff_t>(array.components);
  if (view.count == 0) return view;
  const auto* first = static_cast<const std::byte*>(array.component[0]);
  if (view.rows) {
    const std::optional<std::ptrdiff_t> distance = distance_of_rows(array, view.stride, size);
    if (distance) {
      first = kernels::load<const std::byte*>(first);
      view.rows = false;
      view.stride = *distance;
    }
  }
  for (std::uint32_t c = 0; c < std::min<std::uint32_t>(array.components, 4); ++c) {
    if (view.rows || c == 0) {
      view.base[c] = first;
    } else {
      view.base[c] =
          columns ? static_cast<const std::byte*>(array.component[c]) : first + static_cast<std::ptrdiff_t>(c) * size;
    }
  }
  return view;
}

void ColumnSet::add(const ArrayView& view, const std::string& what) {
  if (view.count == 0) return;
  const std::size_t size = kernels::size_of(view.type);
  const auto writable = [](const std::byte* address) { return const_cast<std::byte*>(address); };
  const bool contiguous = view.rows || view.components == 1 || view.base[1] == view.base[0] + size;
  if (contiguous) {
    bool all = true;
    for (std::uint32_t c = 1; !view.rows && c < std::min<std::uint32_t>(view.components, 4); ++c)
      all = all && view.base[c] == view.base[0] + c * size;
    if (all)
      return add_column({writable(view.base[0]), view.stride, size * view.components, view.rows}, view.count, what);
  }
  for (std::uint32_t c = 0; c < view.components; ++c)
    add_column({writable(view.base[c]), view.stride, size, false}, view.count, what);
}

void ColumnSet::add_column(MovedColumn column, std::uint64_t count, const std::string& what) {
  // A negative stride runs through the same bytes from the other end; two arrays of one record must agree in direction.
  const auto extent = [count](const MovedColumn& c) {
    const std::ptrdiff_t last = static_cast<std::ptrdiff_t>(count - 1) * c.stride;
    const auto base = reinterpret_cast<std::intptr_t>(c.base);
    return std::pair{
        base + std::min<std::ptrdiff_t>(last, 0),
        base + std::max<std::ptrdiff_t>(last, 0) + static_cast<std::ptrdiff_t>(c.rows ? sizeof(void*) : c.bytes)};
  };
  const auto [low, high] = extent(column);
  for (auto other = columns_.begin(); other != columns_.end();) {
    const auto [other_low, other_high] = extent(*other);
    if (high <= other_low || other_high <= low) {
      ++other;
      continue;
    }
    const std::ptrdiff_t shift = column.base - other->base;
    const bool together =
        column.stride == other->stride && column.rows == other->rows && std::abs(shift) < std::abs(column.stride);
    if (together && column.rows && shift == 0) {
      column.bytes = std::max(column.bytes, other->bytes);  // the same table of rows
      other = columns_.erase(other);
      continue;
    }
    const auto bytes = static_cast<std::ptrdiff_t>(column.bytes);
    const auto other_bytes = static_cast<std::ptrdiff_t>(other->bytes);
    if (!together || column.rows)
      throw Error(INSITU_ERROR_INVALID_ARGUMENT,
                  what + ": overlaps another array of the set with another stride; they cannot be permuted together");
    const std::ptrdiff_t begin = std::min<std::ptrdiff_t>(0, -shift);
    const std::ptrdiff_t end = std::max(bytes, other_bytes - shift);
    if (end - begin > std::abs(column.stride))
      throw Error(
          INSITU_ERROR_INVALID_ARGUMENT,
          what + ": reaches into the next record of another array of the set; they cannot be permuted together");
    if (shift >= other_bytes || -shift >= bytes) {
      ++other;  // different fields of the same records
      continue;
    }
    column.base += begin;
    column.bytes = static_cast<std::size_t>(end - begin);
    other = columns_.erase(other);
  }
  columns_.push_back(column);
}

}  // namespace insitu
