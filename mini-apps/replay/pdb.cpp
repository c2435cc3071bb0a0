// PDB files. The records of one model at a time go to gemmi, so that a long trajectory does not fill the memory.
#include <gemmi/pdb.hpp>

#include <exception>
#include <new>

#include "input_error.h"
#include "line_reader.h"
#include "model_frame.h"
#include "numbers.h"
#include "reader.h"

namespace replay {
namespace {

class PdbReader : public FrameReader {
 public:
  PdbReader(const std::string& path, const ReadOptions& options) : lines_(path), hetatm_(options.hetatm) {}

  bool next(Frame& frame) override {
    frame = Frame();
    text_ = cell_record_;
    bool atoms = false;
    while (lines_.next()) {
      const std::string_view line = lines_.line();
      const std::string_view record = trimmed(line.substr(0, 6));
      if (record == "MODEL") {
        if (atoms) {  // the end of the model before was not marked
          lines_.unread();
          break;
        }
        frame.step = model_number();
      } else if (record == "ENDMDL" || record == "END") {
        if (atoms) break;
      } else if (record == "ATOM" || record == "HETATM") {
        check_coordinates();
        atoms = true;
        keep_line();
      } else if (record == "TER") {
        keep_line();
      } else if (record == "CRYST1") {
        cell_record_ = std::string(line) + '\n';
        keep_line();
      }
    }
    if (!atoms) {
      if (frames_ == 0) lines_.fail_at_end("\"ATOM\" or \"HETATM\" records");
      return false;
    }
    ++frames_;
    const gemmi::Structure structure = parse();
    frame_from_model(structure.models[0], hetatm_, frame);
    frame.box = box_from_cell(structure.cell);
    derive_attributes(frame);
    return true;
  }

 private:
  // Up to the element: charges, which follow, are not used, and gemmi refuses odd ones.
  void keep_line() {
    constexpr std::size_t columns_needed = 78;
    text_.append(lines_.line().substr(0, columns_needed));
    text_ += '\n';
  }

  std::optional<std::uint64_t> model_number() const {
    std::int64_t number = 0;
    if (lines_.words().size() < 2 || !parse_whole(lines_.words()[1], number) || number < 0) return std::nullopt;
    return static_cast<std::uint64_t>(number);
  }

  // gemmi reads 0 where there is no number; a picture with wrong atoms is worse than none.
  void check_coordinates() const {
    constexpr std::size_t first_column = 30;
    constexpr std::size_t width = 8;
    const std::string_view line = lines_.line();
    if (line.size() < first_column + 3 * width) {
      lines_.fail("an atom record of " + std::to_string(line.size()) + " characters, expected at least 54");
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t begin = first_column + axis * width;
      double value = 0.0;
      if (!parse_number(trimmed(line.substr(begin, width)), value)) {
        lines_.fail(quoted(line.substr(begin, width)) + " in the columns " + std::to_string(begin + 1) + " to " +
                    std::to_string(begin + width) + ", expected the coordinate " + "xyz"[axis]);
      }
    }
  }

  // What could fail is checked above, where the line is known; so this names the last line of the model.
  gemmi::Structure parse() const {
    try {
      return gemmi::read_pdb_from_memory(text_.data(), text_.size(), lines_.path());
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      lines_.fail(error.what());
    }
  }

  LineReader lines_;
  bool hetatm_;
  std::uint64_t frames_ = 0;
  std::string cell_record_;  // stands before the first model and holds for all
  std::string text_;
};

}  // namespace

std::unique_ptr<FrameReader> open_pdb(const std::string& path, const ReadOptions& options) {
  return std::make_unique<PdbReader>(path, options);
}

}  // namespace replay
