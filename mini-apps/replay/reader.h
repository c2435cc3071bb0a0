// What all file formats have in common: a reader yields one frame after the other and holds no more than one.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frame.h"

namespace replay {

enum class Format { lammps_data, lammps_dump, xyz, pdb, cif, gro, dcd, gadget, hdf5, tipsy };

struct ReadOptions {
  std::optional<Format> format;           // none: found out from the content, then from the file's ending
  std::string atom_style;                 // of LAMMPS data files; empty: as the file says, or by the columns
  bool hetatm = true;                     // PDB and mmCIF: with ligands, ions and water
  std::vector<std::string> trajectories;  // where the positions come from instead, for the particles of the file
};

class FrameReader {
 public:
  virtual ~FrameReader() = default;
  // Replaces `frame` by the next one of the file; false after the last one. Throws InputError.
  virtual bool next(Frame& frame) = 0;
  // What was found out of the file while it was read, for people; may be empty.
  virtual std::string remark() const { return {}; }
};

// "LAMMPS data file" and so on.
const char* format_title(Format format);
// The format of the file by its first lines, or else by its ending. Throws InputError when neither tells.
Format detect_format(const std::string& path);

// Of the file, or of its trajectories when there are some.
std::unique_ptr<FrameReader> open_reader(const std::string& path, const ReadOptions& options);

// One per format, each in a file of its own; open_reader calls them.
std::unique_ptr<FrameReader> open_lammps_data(const std::string& path, const ReadOptions& options);
std::unique_ptr<FrameReader> open_lammps_dump(const std::string& path);
std::unique_ptr<FrameReader> open_xyz(const std::string& path);
std::unique_ptr<FrameReader> open_pdb(const std::string& path, const ReadOptions& options);
std::unique_ptr<FrameReader> open_cif(const std::string& path, const ReadOptions& options);
std::unique_ptr<FrameReader> open_gro(const std::string& path);
std::unique_ptr<FrameReader> open_dcd(const std::string& path);
std::unique_ptr<FrameReader> open_gadget_binary(const std::string& path);
std::unique_ptr<FrameReader> open_gadget_hdf5(const std::string& path);
std::unique_ptr<FrameReader> open_tipsy(const std::string& path);
// The first step of the file, again and again, with the positions of each step of the trajectories.
std::unique_ptr<FrameReader> open_trajectories(const std::string& path, const ReadOptions& options);

}  // namespace replay
