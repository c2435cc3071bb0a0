// GROMACS GRO files (GROMACS reference manual, "File formats"): columns of fixed width in nm, any number of steps. They
// become Angstrom here, as PDB files and the radii of atoms are.
#include <algorithm>
#include <cmath>
#include <map>

#include "atom_names.h"
#include "gro.h"
#include "input_error.h"
#include "line_reader.h"
#include "reader.h"

namespace replay {
namespace {

constexpr double angstrom_per_nm = 10.0;
constexpr std::size_t names_width = 20;  // residue number and name, atom name and number, five columns each

class GroReader : public FrameReader {
 public:
  explicit GroReader(const std::string& path) : lines_(path) {}

  bool next(Frame& frame) override {
    frame = Frame();
    // Only blank lines may stand behind the last step; a title may be blank too.
    if (frames_ > 0 ? !lines_.next_filled() : !lines_.next()) return false;
    read_title(frame);
    const std::uint64_t count = read_count();
    begin(frame);
    for (std::uint64_t i = 0; i < count; ++i) read_atom(i, count, frame);
    if (!velocity_known_) frame.remove("velocity");
    read_box(frame.box);
    ++frames_;
    derive_attributes(frame);
    return true;
  }

 private:
  // "Protein in water t= 20.00000 step= 10000": GROMACS puts the time in ps and the step behind the title.
  void read_title(Frame& frame) const {
    const Words& words = lines_.words();
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
      double time = 0.0;
      std::int64_t step = 0;
      if (words[i] == "t=" && parse_number(words[i + 1], time)) frame.time = time;
      if (words[i] == "step=" && parse_whole(words[i + 1], step) && step >= 0) {
        frame.step = static_cast<std::uint64_t>(step);
      }
    }
  }

  std::uint64_t read_count() {
    if (!lines_.next()) lines_.fail_at_end("the number of atoms");
    std::int64_t count = 0;
    if (lines_.words().size() != 1 || !parse_whole(lines_.words()[0], count) || count < 0) {
      lines_.fail(quoted(lines_.line()) + ", expected the number of atoms");
    }
    return static_cast<std::uint64_t>(count);
  }

  void begin(Frame& frame) {
    width_ = 0;
    for (const char* name : {"element", "type", "id", "residue"}) {
      frame.add(name).categorical = name[0] == 'e' || name[0] == 't';
    }
    frame.add("velocity", 3);
  }

  void read_atom(std::uint64_t i, std::uint64_t count, Frame& frame) {
    const auto expected = [&] { return "atom " + std::to_string(i + 1) + " of " + std::to_string(count); };
    if (!lines_.next()) lines_.fail_at_end(expected());
    const std::string_view line = lines_.line();
    if (i == 0) {
      width_ = gro_number_width(line);
      velocity_known_ = width_ > 0 && !trimmed(line.substr(std::min(line.size(), names_width + 3 * width_))).empty();
    }
    const std::size_t needed = names_width + 3 * width_;
    if (width_ == 0 || line.size() < needed) {
      lines_.fail(quoted(line) + ", expected " + expected() + " with names in 20 columns and x, y, z");
    }
    const std::string_view residue = trimmed(line.substr(5, 5));
    const std::string_view atom = trimmed(line.substr(10, 5));
    const double values[] = {static_cast<double>(element_of_atom(atom, residue)), type_of(residue),
                             whole(line.substr(15, 5), "the number of the atom"),
                             whole(line.substr(0, 5), "the number of the residue")};
    for (std::size_t a = 0; a < 4; ++a) frame.attributes[a].values().push_back(values[a]);
    for (std::size_t c = 0; c < 3; ++c) frame.position.push_back(angstrom_per_nm * number(names_width, c, "xyz"[c]));
    if (!velocity_known_) return;
    // In nm/ps; written with one more digit, so that it takes the same number of columns.
    for (std::size_t c = 0; c < 3; ++c) {
      frame.attributes[4].values().push_back(angstrom_per_nm * number(needed, c, "xyz"[c]));
    }
  }

  // Residues by name, 1, 2, ... in the order in which they first appear in the file.
  double type_of(std::string_view residue) {
    const auto found = types_.find(residue);
    if (found != types_.end()) return found->second;
    return types_.emplace(residue, static_cast<double>(types_.size() + 1)).first->second;
  }

  double whole(std::string_view text, const char* what) const {
    std::int64_t value = 0;
    if (!parse_whole(trimmed(text), value)) lines_.fail(quoted(text) + ", expected " + what);
    return static_cast<double>(value);
  }

  double number(std::size_t begin, std::size_t component, char axis) const {
    const std::string_view line = lines_.line();
    const std::size_t at = begin + component * width_;
    const std::string_view text = at < line.size() ? line.substr(at, width_) : std::string_view();
    double value = 0.0;
    if (!parse_number(trimmed(text), value)) {
      lines_.fail(quoted(text) + " in the columns " + std::to_string(at + 1) + " to " + std::to_string(at + width_) +
                  ", expected the component " + axis + (begin == names_width ? " of a position" : " of a velocity"));
    }
    return value;
  }

  // Three edges along the axes, then six components off them: v1y v1z v2x v2z v3x v3y. All 0: there is no box.
  void read_box(Box& box) {
    if (!lines_.next()) lines_.fail_at_end("the box");
    const Words& words = lines_.words();
    double v[9] = {};
    bool good = words.size() == 3 || words.size() == 9;
    for (std::size_t i = 0; good && i < words.size(); ++i) good = parse_number(words[i], v[i]);
    if (!good) lines_.fail(quoted(lines_.line()) + " as box, expected three or nine numbers");
    for (double& length : v) length *= angstrom_per_nm;
    box.known = v[0] > 0.0 && v[1] > 0.0 && v[2] > 0.0;
    if (!box.known) return;
    box.edge[0] = {v[0], v[3], v[4]};
    box.edge[1] = {v[5], v[1], v[6]};
    box.edge[2] = {v[7], v[8], v[2]};
  }

  LineReader lines_;
  std::uint64_t frames_ = 0;
  std::size_t width_ = 0;
  bool velocity_known_ = false;
  std::map<std::string, double, std::less<>> types_;
};

}  // namespace

std::size_t gro_number_width(std::string_view line) {
  if (line.size() <= names_width) return 0;
  const std::size_t first = line.find('.', names_width);
  const std::size_t second = first == std::string_view::npos ? first : line.find('.', first + 1);
  if (second == std::string_view::npos) return 0;
  const std::size_t width = second - first;
  // The digits behind the point are five fewer than the columns.
  const std::size_t expected_first = names_width + 4;
  return width > 5 && first == expected_first && line.size() >= names_width + 3 * width ? width : 0;
}

bool is_gro_atom(std::string_view line) {
  const std::size_t width = gro_number_width(line);
  std::int64_t whole = 0;
  if (width == 0 || !parse_whole(trimmed(line.substr(0, 5)), whole) ||
      !parse_whole(trimmed(line.substr(15, 5)), whole)) {
    return false;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    double number = 0.0;
    if (!parse_number(trimmed(line.substr(names_width + c * width, width)), number)) return false;
  }
  return true;
}

std::unique_ptr<FrameReader> open_gro(const std::string& path) { return std::make_unique<GroReader>(path); }

}  // namespace replay
