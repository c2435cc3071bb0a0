#include "reader.h"

#include <array>
#include <string_view>
#include <utility>

#include "input_error.h"
#include "line_reader.h"
#include "numbers.h"

namespace replay {
namespace {

constexpr int lines_to_look_at = 100;

bool is_pdb_record(std::string_view line) {
  constexpr std::array<std::string_view, 14> records = {"HEADER", "TITLE ", "COMPND", "REMARK", "CRYST1",
                                                        "ATOM  ", "HETATM", "MODEL ", "AUTHOR", "EXPDTA",
                                                        "SEQRES", "OBSLTE", "SPLIT ", "NUMMDL"};
  for (const std::string_view record : records) {
    if (line.substr(0, record.size()) == record) return true;
  }
  return false;
}

// "2160 atoms": the one line that every LAMMPS data file has near its top.
bool is_atom_count(const Words& words) {
  std::int64_t count = 0;
  return words.size() >= 2 && words[1] == "atoms" && parse_whole(words[0], count);
}

std::optional<Format> format_of_content(const std::string& path) {
  LineReader lines(path);
  bool count_on_first_line = false;
  bool only_comments = true;
  for (int i = 0; i < lines_to_look_at && lines.next(); ++i) {
    const std::string_view line = lines.line();
    if (line.substr(0, 5) == "ITEM:") return Format::lammps_dump;
    if (is_pdb_record(line)) return Format::pdb;
    if (only_comments && line.substr(0, 5) == "data_") return Format::cif;
    if (is_atom_count(lines.words())) return Format::lammps_data;
    std::int64_t count = 0;
    if (i == 0) count_on_first_line = lines.words().size() == 1 && parse_whole(lines.words()[0], count);
    only_comments = only_comments && (lines.words().empty() || line[0] == '#');
  }
  if (count_on_first_line) return Format::xyz;
  return std::nullopt;
}

bool ends_with(std::string_view text, std::string_view ending) {
  return text.size() > ending.size() && equal_ignoring_case(text.substr(text.size() - ending.size()), ending);
}

std::optional<Format> format_of_ending(std::string_view path) {
  if (ends_with(path, ".gz")) path.remove_suffix(3);
  constexpr std::pair<std::string_view, Format> endings[] = {
      {".data", Format::lammps_data}, {".lmp", Format::lammps_data},
      {".dump", Format::lammps_dump}, {".lammpstrj", Format::lammps_dump},
      {".xyz", Format::xyz},          {".extxyz", Format::xyz},
      {".pdb", Format::pdb},          {".ent", Format::pdb},
      {".cif", Format::cif},          {".mmcif", Format::cif},
  };
  for (const auto& [ending, format] : endings) {
    if (ends_with(path, ending)) return format;
  }
  return std::nullopt;
}

}  // namespace

const char* format_title(Format format) {
  switch (format) {
    case Format::lammps_data:
      return "LAMMPS data file";
    case Format::lammps_dump:
      return "LAMMPS text dump";
    case Format::xyz:
      return "XYZ file";
    case Format::pdb:
      return "PDB file";
    case Format::cif:
      return "CIF file";
  }
  return "";
}

Format detect_format(const std::string& path) {
  if (const auto format = format_of_content(path)) return *format;
  if (const auto format = format_of_ending(path)) return *format;
  throw InputError(path, 0,
                   "the format is not known, expected a LAMMPS data or dump file, XYZ, PDB or mmCIF "
                   "(--format says which one it is)");
}

std::unique_ptr<FrameReader> open_reader(const std::string& path, const ReadOptions& options) {
  switch (options.format ? *options.format : detect_format(path)) {
    case Format::lammps_data:
      return open_lammps_data(path, options);
    case Format::lammps_dump:
      return open_lammps_dump(path);
    case Format::xyz:
      return open_xyz(path);
    case Format::pdb:
      return open_pdb(path, options);
    case Format::cif:
      return open_cif(path, options);
  }
  return nullptr;
}

}  // namespace replay
