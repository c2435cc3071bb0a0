// DCD trajectories (CHARMM, NAMD, X-PLOR, LAMMPS): Fortran records of positions alone. Both byte orders, record sizes
// of 4 or 8 bytes, fixed atoms and unit cells, as CHARMM's documentation (dynamc.doc) and VMD's reader describe them.
#include "dcd.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "byte_reader.h"
#include "input_error.h"
#include "reader.h"

namespace replay {
namespace {

constexpr std::size_t header_bytes = 84;

double cosine_of(double value) {
  // CHARMM and NAMD write cosines, others degrees; an angle of less than one degree is none of a cell.
  return std::abs(value) <= 1.0 ? value : std::cos(value * std::numbers::pi / 180.0);
}

// Lengths A, B, C and the angles between them as A, gamma, B, beta, alpha, C.
Box box_of(const std::vector<double>& cell) {
  const double a = cell[0];
  const double b = cell[2];
  const double c = cell[5];
  const double cos_gamma = cosine_of(cell[1]);
  const double cos_beta = cosine_of(cell[3]);
  const double cos_alpha = cosine_of(cell[4]);
  const double sin_gamma = std::sqrt(1.0 - cos_gamma * cos_gamma);
  const double cy = (cos_alpha - cos_beta * cos_gamma) / sin_gamma;
  const double cz_squared = 1.0 - cos_beta * cos_beta - cy * cy;
  if (!(a > 0.0 && b > 0.0 && c > 0.0 && sin_gamma > 0.0 && cz_squared > 0.0)) return {};
  Box box;
  box.known = true;
  box.edge[0] = {a, 0.0, 0.0};
  box.edge[1] = {b * cos_gamma, b * sin_gamma, 0.0};
  box.edge[2] = {c * cos_beta, c * cy, c * std::sqrt(cz_squared)};
  return box;
}

class DcdReader : public FrameReader {
 public:
  explicit DcdReader(const std::string& path) : bytes_(path) {}

  bool next(Frame& frame) override {
    frame = Frame();
    if (frames_ == 0) read_header();
    if (bytes_.at_end()) {
      if (frames_ == 0) bytes_.fail("the file ends here, expected the positions of the first step");
      return false;
    }
    read_cell(frame.box);
    read_positions(frame);
    if (has_fourth_dimension_) skip_record("the fourth dimension");
    frame.step = first_step_ + frames_ * steps_between_;
    frame.time = static_cast<double>(*frame.step) * step_ps_;
    ++frames_;
    return true;
  }

  std::string remark() const override { return remark_; }

 private:
  std::uint64_t begin_record(const char* what) {
    return wide_markers_ ? bytes_.number<std::uint64_t>(what) : bytes_.number<std::uint32_t>(what);
  }
  void end_record(std::uint64_t bytes, const char* what) {
    const std::uint64_t end = begin_record(what);
    if (end != bytes) {
      bytes_.fail("the record of " + std::string(what) + " has " + std::to_string(bytes) +
                  " bytes by the number before it and " + std::to_string(end) + " by that behind it");
    }
  }
  template <class T>
  std::vector<T> record(std::uint64_t count, const char* what) {
    const std::uint64_t bytes = begin_record(what);
    if (bytes != count * sizeof(T)) {
      bytes_.fail("the record of " + std::string(what) + " has " + std::to_string(bytes) + " bytes, expected " +
                  std::to_string(count * sizeof(T)));
    }
    std::vector<T> values;
    bytes_.numbers(count, what, values);
    end_record(bytes, what);
    return values;
  }
  void skip_record(const char* what) {
    const std::uint64_t bytes = begin_record(what);
    bytes_.skip(bytes, what);
    end_record(bytes, what);
  }

  void read_header() {
    const auto layout = dcd_layout(bytes_.peek(16));
    if (!layout) bytes_.fail("is no DCD trajectory, expected a first record of 84 bytes that begins with \"CORD\"");
    if (layout->velocities) bytes_.fail("holds velocities (\"VELD\"), expected positions (\"CORD\")");
    wide_markers_ = layout->wide_markers;
    bytes_.set_order(layout->order);
    remark_ = layout->order == std::endian::big ? "big-endian" : "little-endian";

    const char* const what = "the header";
    const std::uint64_t size = begin_record(what);
    bytes_.skip(4, what);  // "CORD"
    std::array<std::int32_t, 9> counts;
    for (auto& count : counts) count = bytes_.number<std::int32_t>(what);
    first_step_ = static_cast<std::uint64_t>(std::max(counts[1], 0));
    steps_between_ = static_cast<std::uint64_t>(std::max(counts[2], 1));
    const std::int32_t fixed = counts[8];
    // CHARMM marks its files with its version; X-PLOR has a double where CHARMM has a float and two flags.
    std::array<std::uint32_t, 11> rest;
    for (auto& word : rest) word = bytes_.number<std::uint32_t>(what);
    const bool charmm = rest[10] != 0;
    has_cell_ = charmm && rest[1] != 0;
    has_fourth_dimension_ = charmm && rest[2] != 0;
    step_ps_ = time_step(charmm, rest[0], rest[1]);
    end_record(size, what);

    skip_record("the titles");
    const std::int32_t atoms = record<std::int32_t>(1, "the number of atoms")[0];
    if (atoms < 0) bytes_.fail(std::to_string(atoms) + " atoms, expected 0 or more");
    if (fixed < 0 || fixed > atoms) {
      bytes_.fail(std::to_string(fixed) + " fixed atoms, expected 0 to " + std::to_string(atoms));
    }
    atoms_ = static_cast<std::size_t>(atoms);
    has_fixed_ = fixed > 0;
    if (!has_fixed_) return;
    free_ = record<std::int32_t>(atoms_ - static_cast<std::size_t>(fixed), "the free atoms");
    for (const std::int32_t atom : free_) {
      if (atom < 1 || atom > atoms)
        bytes_.fail("a free atom " + std::to_string(atom) + ", expected 1 to " + std::to_string(atoms));
    }
  }

  // In ps. Both programs count time in units of sqrt(amu Angstrom^2 mol / kcal).
  double time_step(bool charmm, std::uint32_t word0, std::uint32_t word1) const {
    constexpr double unit_ps = 0.04888821;
    if (charmm) return static_cast<double>(std::bit_cast<float>(word0)) * unit_ps;
    // The words were put into the order of this machine one by one; the two halves of a double come in the file's.
    const bool big = remark_ == "big-endian";
    const std::uint64_t high = big ? word0 : word1;
    const std::uint64_t low = big ? word1 : word0;
    return std::bit_cast<double>(high << 32 | low) * unit_ps;
  }

  void read_cell(Box& box) {
    if (has_cell_) box = box_of(record<double>(6, "the unit cell"));
  }

  // With fixed atoms only the first step has all of them.
  void read_positions(Frame& frame) {
    constexpr const char* axes[3] = {"the x coordinates", "the y coordinates", "the z coordinates"};
    const bool some = frames_ > 0 && has_fixed_;
    if (some) frame.position = first_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::vector<float> x = record<float>(some ? free_.size() : atoms_, axes[axis]);
      if (axis == 0 && !some) frame.position.resize(3 * x.size());
      for (std::size_t i = 0; i < x.size(); ++i) {
        const std::size_t atom = some ? static_cast<std::size_t>(free_[i]) - 1 : i;
        frame.position[3 * atom + axis] = static_cast<double>(x[i]);
      }
    }
    if (frames_ == 0 && has_fixed_) first_ = frame.position;
  }

  ByteReader bytes_;
  bool wide_markers_ = false;
  bool has_cell_ = false;
  bool has_fourth_dimension_ = false;
  bool has_fixed_ = false;
  std::size_t atoms_ = 0;
  std::vector<std::int32_t> free_;  // counted from 1
  std::vector<double> first_;       // positions of the first step, for the fixed atoms
  std::uint64_t first_step_ = 0;
  std::uint64_t steps_between_ = 1;
  double step_ps_ = 0.0;
  std::uint64_t frames_ = 0;
  std::string remark_;
};

}  // namespace

std::optional<DcdLayout> dcd_layout(std::string_view first_bytes) {
  for (const bool wide : {false, true}) {
    const std::size_t marker_bytes = wide ? 8 : 4;
    if (first_bytes.size() < marker_bytes + 4) return std::nullopt;
    const std::string_view marker = first_bytes.substr(0, marker_bytes);
    const std::string_view word = first_bytes.substr(marker_bytes, 4);
    if (word != "CORD" && word != "VELD") continue;
    std::string big(marker_bytes, '\0');
    big.back() = static_cast<char>(header_bytes);
    const std::string little(big.rbegin(), big.rend());
    if (marker == big) return DcdLayout{std::endian::big, wide, word == "VELD"};
    if (marker == little) return DcdLayout{std::endian::little, wide, word == "VELD"};
  }
  return std::nullopt;
}

std::unique_ptr<FrameReader> open_dcd(const std::string& path) { return std::make_unique<DcdReader>(path); }

}  // namespace replay
