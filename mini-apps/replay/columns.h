// Turns rows of words into a frame: each column of a table becomes a coordinate, a named attribute or nothing.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "frame.h"
#include "line_reader.h"

namespace replay {

struct Column {
  enum class Kind {
    skip,
    position,  // component 0, 1 or 2
    number,    // into component `component` of the attribute `name`
    element,   // a symbol such as "Na", or an atomic number
    category,  // any text: its first appearance in the file gives it a number, 1, 2, ...
    species,   // as element, and as category "type"
    truth      // T or F, 1 or 0
  };
  Kind kind = Kind::skip;
  std::string name;
  std::uint32_t component = 0;
  std::uint32_t components = 1;
  bool categorical = false;
  bool whole = false;  // a number without a fraction
};

class ColumnReader {
 public:
  // Of columns that would go to the same place the first one counts.
  explicit ColumnReader(std::vector<Column> columns);

  std::size_t size() const { return columns_.size(); }
  // Before begin().
  void set_kind(std::size_t column, Column::Kind kind);
  // Gives the frame its empty attributes; rows are then appended to it.
  void begin(Frame& frame);
  // `words` may be longer than there are columns. Errors are those of the present line of `lines`.
  void read_row(const Words& words, const LineReader& lines, Frame& frame);

 private:
  void drop_duplicates();
  double category(std::size_t column, std::string_view text);

  std::vector<Column> columns_;
  std::vector<std::size_t> target_;  // place of each column's attribute in the frame
  std::size_t type_target_ = 0;      // where a species column puts its category
  std::vector<std::map<std::string, double, std::less<>>> categories_;
};

}  // namespace replay
