// mmCIF, the models of a macromolecule, and CIF of crystals.
#include <gemmi/mmcif.hpp>

#include <exception>
#include <new>
#include <utility>

#include "cif_block.h"
#include "crystal.h"
#include "input_error.h"
#include "line_reader.h"
#include "model_frame.h"
#include "numbers.h"
#include "reader.h"

namespace replay {
namespace {

class CifReader : public FrameReader {
 public:
  CifReader(const std::string& path, const ReadOptions& options) : path_(path), hetatm_(options.hetatm) {}

  bool next(Frame& frame) override {
    if (!std::exchange(opened_, true)) open();
    frame = Frame();
    if (crystal_) {
      frame = std::move(*std::exchange(crystal_, std::nullopt));
      return true;
    }
    if (next_model_ == structure_.models.size()) return false;
    const gemmi::Model& model = structure_.models[next_model_++];
    std::int64_t number = 0;
    if (structure_.models.size() > 1 && parse_whole(model.name, number) && number >= 0) {
      frame.step = static_cast<std::uint64_t>(number);
    }
    frame_from_model(model, hetatm_, frame);
    frame.box = box_from_cell(structure_.cell);
    derive_attributes(frame);
    return true;
  }

 private:
  void open() {
    LineReader lines(path_);
    gemmi::cif::Block block = read_cif_block(lines);
    const gemmi::cif::Item* const sites = block.find_values("_atom_site.Cartn_x").item();
    const gemmi::cif::Item* const crystal = block.find_values("_atom_site_fract_x").item();
    if (!sites && !crystal) {
      lines.fail_at_end("a loop with _atom_site.Cartn_x (mmCIF) or _atom_site_fract_x (crystals)");
    }
    const int line = (sites ? sites : crystal)->line_number;
    try {
      if (sites) {
        structure_ = gemmi::make_structure_from_block(block);
      } else {
        crystal_ = crystal_frame(block);
        derive_attributes(*crystal_);
      }
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {  // gemmi throws what its helpers throw
      throw InputError(path_, static_cast<std::size_t>(line), error.what());
    }
    if (sites && structure_.models.empty()) {
      throw InputError(path_, static_cast<std::size_t>(line),
                       "the loop of atoms has no rows, or not all columns that are needed, expected those of mmCIF "
                       "(id, type_symbol, label_alt_id, label_asym_id, occupancy, B_iso_or_equiv, auth_seq_id, ...)");
    }
  }

  std::string path_;
  bool hetatm_;
  bool opened_ = false;
  gemmi::Structure structure_;
  std::optional<Frame> crystal_;
  std::size_t next_model_ = 0;
};

}  // namespace

std::unique_ptr<FrameReader> open_cif(const std::string& path, const ReadOptions& options) {
  return std::make_unique<CifReader>(path, options);
}

}  // namespace replay
