#include "model_frame.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace replay {
namespace {

class Collector {
 public:
  explicit Collector(Frame& frame) : frame_(frame) {
    frame.position.clear();
    frame.attributes.clear();
    for (const char* name : {"element", "id", "bfactor", "occupancy", "chain", "residue", "hetatm"}) {
      frame.add(name).categorical = std::string(name) == "element" || std::string(name) == "chain";
    }
  }

  void add(const gemmi::Atom& atom, const gemmi::Residue& residue, double chain) {
    frame_.position.insert(frame_.position.end(), {atom.pos.x, atom.pos.y, atom.pos.z});
    const bool is_known = atom.element.elem != gemmi::El::X && atom.element.elem < gemmi::El::END;
    const double values[] = {is_known ? static_cast<double>(atom.element.atomic_number()) : 0.0,
                             static_cast<double>(atom.serial),
                             static_cast<double>(atom.b_iso),
                             static_cast<double>(atom.occ),
                             chain,
                             residue.seqid.num.has_value() ? static_cast<double>(residue.seqid.num.value) : 0.0,
                             residue.het_flag == 'H' ? 1.0 : 0.0};
    for (std::size_t i = 0; i < std::size(values); ++i) frame_.attributes[i].values().push_back(values[i]);
  }

 private:
  Frame& frame_;
};

// Two kinds of residue at one place of the chain, told apart by alternative locations: the second one is not drawn.
bool is_alternative_residue(const gemmi::Residue& residue, const gemmi::Residue* before) {
  if (!before || before->seqid != residue.seqid || before->name == residue.name) return false;
  return std::all_of(residue.atoms.begin(), residue.atoms.end(), [](const gemmi::Atom& a) { return a.has_altloc(); });
}

}  // namespace

void frame_from_model(const gemmi::Model& model, bool hetatm, Frame& frame) {
  Collector collector(frame);
  std::map<std::string, double> chain_numbers;
  for (const gemmi::Chain& chain : model.chains) {
    const double chain_number =
        chain_numbers.emplace(chain.name, static_cast<double>(chain_numbers.size() + 1)).first->second;
    const gemmi::Residue* before = nullptr;
    for (const gemmi::Residue& residue : chain.residues) {
      const bool alternative = is_alternative_residue(residue, before);
      if (!alternative) before = &residue;
      if (alternative || (!hetatm && residue.het_flag == 'H')) continue;
      std::map<std::string, char> first_location;
      for (const gemmi::Atom& atom : residue.atoms) {
        if (atom.has_altloc() && first_location.emplace(atom.name, atom.altloc).first->second != atom.altloc) continue;
        collector.add(atom, residue, chain_number);
      }
    }
  }
}

Box box_from_cell(const gemmi::UnitCell& cell) {
  Box box;
  box.known = cell.is_crystal();
  for (int k = 0; k < 3; ++k) {
    const gemmi::Position edge = cell.orthogonalize(gemmi::Fractional(k == 0, k == 1, k == 2));
    box.edge[static_cast<std::size_t>(k)] = {edge.x, edge.y, edge.z};
  }
  return box;
}

}  // namespace replay
