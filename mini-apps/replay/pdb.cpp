// PDB files. The records of one model at a time go to gemmi, so that a long trajectory does not fill the memory.
#include <gemmi/pdb.hpp>

#include <exception>
#include <new>

#include "atom_names.h"
#include "hybrid36.h"
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
    ids_.clear();
    elements_.clear();
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
        name_element();
        number_atom();
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
    restore_order(frame);
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

  // Where the columns of the element are blank gemmi goes by the column in which the name begins, but many programs
  // write all names from the left: C-alpha would be calcium.
  void name_element() {
    constexpr std::size_t element_column = 76;
    const std::string_view line = lines_.line();
    const bool is_named = line.size() > element_column && !trimmed(line.substr(element_column, 2)).empty();
    elements_.push_back(is_named
                            ? std::nullopt
                            : std::optional(element_of_atom(trimmed(line.substr(12, 4)), trimmed(line.substr(17, 3)))));
  }

  // gemmi collects the atoms of a residue, and where a long file begins to count its residues anew that moves atoms.
  // The order matters when positions come from a trajectory; so atoms are numbered by their place in the file.
  void number_atom() {
    constexpr std::size_t id_column = 6;
    const std::size_t line_begin = text_.rfind('\n', text_.size() - 2) + 1;
    const std::string place = hybrid36(ids_.size());
    const std::string_view id = std::string_view(text_).substr(line_begin + id_column, place.size());
    ids_.push_back(static_cast<double>(parse_hybrid36(id).value_or(0)));
    text_.replace(line_begin + id_column, place.size(), place);
  }
  void restore_order(Frame& frame) const {
    sort_by(frame, "id");
    std::vector<double>& ids = frame.find("id")->values();
    std::vector<double>& elements = frame.find("element")->values();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const auto place = static_cast<std::size_t>(ids[i]);
      ids[i] = ids_[place];
      if (elements_[place]) elements[i] = *elements_[place];
    }
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
  // Of the atoms of the model, in the order of the file.
  std::vector<double> ids_;
  std::vector<std::optional<int>> elements_;  // where the columns for it are blank
};

}  // namespace

std::unique_ptr<FrameReader> open_pdb(const std::string& path, const ReadOptions& options) {
  return std::make_unique<PdbReader>(path, options);
}

}  // namespace replay
