#include "lammps_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>

#include "input_error.h"
#include "numbers.h"

namespace replay {
namespace {

constexpr std::string_view section_titles[] = {"Masses",
                                               "Atoms",
                                               "Velocities",
                                               "Ellipsoids",
                                               "Lines",
                                               "Triangles",
                                               "Bodies",
                                               "Bonds",
                                               "Angles",
                                               "Dihedrals",
                                               "Impropers",
                                               "Atom Type Labels",
                                               "Bond Type Labels",
                                               "Angle Type Labels",
                                               "Dihedral Type Labels",
                                               "Improper Type Labels",
                                               "Pair Coeffs",
                                               "PairIJ Coeffs",
                                               "Bond Coeffs",
                                               "Angle Coeffs",
                                               "Dihedral Coeffs",
                                               "Improper Coeffs",
                                               "BondBond Coeffs",
                                               "BondBond13 Coeffs",
                                               "BondAngle Coeffs",
                                               "AngleAngle Coeffs",
                                               "AngleTorsion Coeffs",
                                               "AngleAngleTorsion Coeffs",
                                               "MiddleBondTorsion Coeffs",
                                               "EndBondTorsion Coeffs"};

std::optional<std::uint64_t> step_in_title(std::string_view title) {
  constexpr std::string_view key = "timestep = ";
  const std::size_t at = title.find(key);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view text = title.substr(at + key.size());
  std::uint64_t step = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), step).ec != std::errc()) return std::nullopt;
  return step;
}

// Collects the lines that describe the box, in whatever order they come.
class BoxLines {
 public:
  bool take(const Words& words, const LineReader& lines) {
    if (words.size() == 4 && is_bounds(words[2], words[3])) {
      const auto axis = static_cast<std::size_t>(words[2][0] - 'x');
      lower_[axis] = number_in(lines, words[0]);
      upper_[axis] = number_in(lines, words[1]);
      return any_ = true;
    }
    if (words.size() == 6 && words[3] == "xy" && words[4] == "xz" && words[5] == "yz") {
      for (std::size_t i = 0; i < 3; ++i) tilt_[i] = number_in(lines, words[i]);
      return true;
    }
    if (words.size() == 4 && (words[3] == "avec" || words[3] == "bvec" || words[3] == "cvec")) {
      auto& edge = general_.edge[static_cast<std::size_t>(words[3][0] - 'a')];
      for (std::size_t i = 0; i < 3; ++i) edge[i] = number_in(lines, words[i]);
      return general_.known = true;
    }
    if (words.size() == 5 && words[3] == "abc" && words[4] == "origin") {
      for (std::size_t i = 0; i < 3; ++i) general_.origin[i] = number_in(lines, words[i]);
      return general_.known = true;
    }
    return false;
  }
  Box box() const {
    if (general_.known) return general_;
    return any_ ? Box::from_bounds(lower_, upper_, tilt_[0], tilt_[1], tilt_[2]) : Box();
  }

 private:
  static bool is_bounds(std::string_view low, std::string_view high) {
    return low.size() == 3 && high.size() == 3 && low[0] >= 'x' && low[0] <= 'z' && low[0] == high[0] &&
           low.substr(1) == "lo" && high.substr(1) == "hi";
  }

  bool any_ = false;
  std::array<double, 3> lower_ = {-0.5, -0.5, -0.5};  // what LAMMPS takes where a file says nothing
  std::array<double, 3> upper_ = {0.5, 0.5, 0.5};
  std::array<double, 3> tilt_ = {};
  Box general_;
};

}  // namespace

DataHeader read_data_header(LineReader& lines) {
  DataHeader header;
  lines.next();
  header.step = step_in_title(lines.line());
  bool counted = false;
  BoxLines box;
  Words words;
  while (true) {
    if (!lines.next_filled()) {
      if (counted && header.atoms == 0) break;
      lines.fail_at_end(counted ? "a section \"Atoms\"" : "the number of atoms (\"N atoms\")");
    }
    if (is_section_title(lines)) {
      if (!counted) lines.fail("the number of atoms is missing above, expected \"N atoms\"");
      break;
    }
    split_words(without_comment(lines.line()), words);
    // Lines that are none of these count bonds and the like, or are of later versions of the format.
    if (words.size() == 2 && words[1] == "atoms") {
      header.atoms = count_in(lines, words[0], "the number of atoms");
      counted = true;
    } else if (words.size() == 2 && words[1] == "ellipsoids") {
      header.ellipsoids = count_in(lines, words[0], "the number of ellipsoids");
    } else if (words.size() == 3 && words[1] == "atom" && words[2] == "types") {
      header.types = static_cast<std::int64_t>(count_in(lines, words[0], "the number of atom types"));
    } else if (!box.take(words, lines) && !counted && !words.empty() && starts_with_letter(words[0])) {
      lines.fail(quoted(lines.line()) + ", expected the header of a LAMMPS data file (\"N atoms\")");
    }
  }
  header.box = box.box();
  return header;
}

bool is_section_title(const LineReader& lines) {
  if (lines.words().empty() || !starts_with_letter(lines.words()[0])) return false;
  const std::string_view title = without_comment(lines.line());
  return std::find(std::begin(section_titles), std::end(section_titles), title) != std::end(section_titles);
}

std::string_view without_comment(std::string_view line) { return trimmed(line.substr(0, line.find('#'))); }

std::string_view comment_of(std::string_view line) {
  const std::size_t hash = line.find('#');
  return hash == std::string_view::npos ? std::string_view() : trimmed(line.substr(hash + 1));
}

double number_in(const LineReader& lines, std::string_view text) {
  double value = 0.0;
  if (!parse_number(text, value)) lines.fail(quoted(text) + ", expected a number");
  return value;
}

std::uint64_t count_in(const LineReader& lines, std::string_view text, const char* what) {
  std::int64_t value = 0;
  if (!parse_whole(text, value) || value < 0) lines.fail(quoted(text) + ", expected " + what);
  return static_cast<std::uint64_t>(value);
}

}  // namespace replay
