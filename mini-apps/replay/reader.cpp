#include "reader.h"

#include <array>
#include <string_view>
#include <utility>

#include "byte_reader.h"
#include "dcd.h"
#include "gadget_header.h"
#include "gro.h"
#include "hdf5_file.h"
#include "input_error.h"
#include "line_reader.h"
#include "numbers.h"
#include "tipsy.h"

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

// Binary formats, by their first bytes.
std::optional<Format> format_of_bytes(const std::string& path) {
  ByteReader bytes(path);
  const std::string begin = bytes.peek(tipsy_header_bytes);
  if (is_hdf5(begin)) return Format::hdf5;
  if (dcd_layout(begin)) return Format::dcd;
  if (gadget_layout(begin)) return Format::gadget;
  if (tipsy_header(begin)) return Format::tipsy;
  // Known, but not read: docs/replay.md says why.
  constexpr std::pair<std::string_view, const char*> others[] = {{std::string_view("\0\0\7\xCB", 4), "XTC"},
                                                                 {std::string_view("\0\0\7\xC9", 4), "TRR"}};
  for (const auto& [magic, name] : others) {
    if (std::string_view(begin).substr(0, magic.size()) != magic) continue;
    throw InputError(path, 0,
                     std::string("is a trajectory of GROMACS in the format ") + name +
                         ", which is not read here; \"gmx trjconv\" makes a GRO file of it");
  }
  return std::nullopt;
}

// A title, which may read like anything, a count, and an atom in fixed columns.
bool is_gro(const std::string& path) {
  LineReader lines(path);
  std::int64_t count = 0;
  return lines.next() && lines.next() && lines.words().size() == 1 && parse_whole(lines.words()[0], count) &&
         lines.next() && is_gro_atom(lines.line());
}

std::optional<Format> format_of_content(const std::string& path) {
  if (const auto format = format_of_bytes(path)) return format;
  if (is_gro(path)) return Format::gro;
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
      {".gro", Format::gro},          {".dcd", Format::dcd},
      {".hdf5", Format::hdf5},        {".h5", Format::hdf5},
      {".gadget", Format::gadget},    {".gadget2", Format::gadget},
      {".tipsy", Format::tipsy},      {".tbin", Format::tipsy},
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
    case Format::gro:
      return "GRO file";
    case Format::dcd:
      return "DCD trajectory";
    case Format::gadget:
      return "Gadget snapshot";
    case Format::hdf5:
      return "HDF5 snapshot";
    case Format::tipsy:
      return "TIPSY snapshot";
  }
  return "";
}

Format detect_format(const std::string& path) {
  if (const auto format = format_of_content(path)) return *format;
  if (const auto format = format_of_ending(path)) return *format;
  throw InputError(path, 0,
                   "the format is not known, expected a LAMMPS data or dump file, XYZ, PDB, mmCIF, GRO, DCD, or "
                   "a snapshot of Gadget (also in HDF5) or TIPSY "
                   "(--format says which one it is)");
}

std::unique_ptr<FrameReader> open_reader(const std::string& path, const ReadOptions& options) {
  if (!options.trajectories.empty()) return open_trajectories(path, options);
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
    case Format::gro:
      return open_gro(path);
    case Format::dcd:
      return open_dcd(path);
    case Format::gadget:
      return open_gadget_binary(path);
    case Format::hdf5:
      return open_gadget_hdf5(path);
    case Format::tipsy:
      return open_tipsy(path);
  }
  return nullptr;
}

}  // namespace replay
