// The header of a LAMMPS data file: counts and box, up to the first named section.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "box.h"
#include "line_reader.h"

namespace replay {

struct DataHeader {
  std::optional<std::uint64_t> step;  // LAMMPS writes it into the title
  std::uint64_t atoms = 0;
  std::uint64_t ellipsoids = 0;
  std::int64_t types = 0;
  Box box;
};

// Reads from the first line on and leaves `lines` at the title of the first section, or at the end of the file when
// there are no atoms.
DataHeader read_data_header(LineReader& lines);

// Whether the present line is the title of a section, such as "Atoms # full".
bool is_section_title(const LineReader& lines);

std::string_view without_comment(std::string_view line);
// What stands behind the '#'.
std::string_view comment_of(std::string_view line);

// The present line's number in `text`, or an InputError.
double number_in(const LineReader& lines, std::string_view text);
std::uint64_t count_in(const LineReader& lines, std::string_view text, const char* what);

}  // namespace replay
