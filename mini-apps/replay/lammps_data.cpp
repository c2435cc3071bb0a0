// LAMMPS data files: a header, then named sections in any order. One step per file.
#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include "atom_styles.h"
#include "columns.h"
#include "elements.h"
#include "input_error.h"
#include "lammps_header.h"
#include "numbers.h"
#include "reader.h"

namespace replay {
namespace {

// Enough to see what the columns are, whatever the first particles look like.
constexpr std::size_t rows_to_guess_from = 500;

std::vector<Column> columns_of(const AtomStyle& style) {
  std::vector<Column> columns;
  for (const std::string& name : style.columns) {
    Column column;
    column.name = name;
    column.kind = Column::Kind::number;
    column.whole = is_whole_column(name);
    column.categorical = name == "type" || name == "mol";
    if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') {
      column.kind = Column::Kind::position;
      column.component = static_cast<std::uint32_t>(name[0] - 'x');
    }
    columns.push_back(std::move(column));
  }
  return columns;
}

// The rows behind line `title_line` of the file, without disturbing who reads it.
std::vector<TextRow> rows_behind(const std::string& path, std::size_t title_line, std::uint64_t count) {
  LineReader lines(path);
  while (lines.line_number() < title_line && lines.next()) {
  }
  std::vector<TextRow> rows;
  Words words;
  while (rows.size() < std::min<std::uint64_t>(count, rows_to_guess_from) && lines.next_filled()) {
    if (is_section_title(lines)) break;
    split_words(without_comment(lines.line()), words);
    if (!words.empty()) rows.emplace_back(words.begin(), words.end());
  }
  return rows;
}

class DataReader : public FrameReader {
 public:
  DataReader(const std::string& path, const ReadOptions& options) : lines_(path), style_name_(options.atom_style) {}

  bool next(Frame& frame) override {
    if (done_) return false;
    done_ = true;
    frame = Frame();
    header_ = read_data_header(lines_);
    frame.step = header_.step;
    frame.box = header_.box;
    if (is_section_title(lines_)) {
      do read_section(frame);
      while (go_to_next_section());
    }
    if (!atoms_read_ && header_.atoms > 0) lines_.fail_at_end("a section \"Atoms\"");
    add_elements(frame);
    derive_attributes(frame);
    return true;
  }

  std::string remark() const override {
    if (style_.columns.empty()) return {};
    return "atom style " + style_.name + (style_.guessed ? " (guessed from the columns)" : "");
  }

 private:
  void read_section(Frame& frame) {
    const std::string title(without_comment(lines_.line()));
    if (title == "Masses") read_masses();
    if (title == "Atom Type Labels") read_type_labels();
    if (title == "Atoms") read_atoms(frame);
    if (title == "Velocities") read_velocities(frame);
    if (title == "Ellipsoids") read_ellipsoids(frame);
  }

  bool go_to_next_section() {
    while (lines_.next_filled()) {
      if (is_section_title(lines_)) return true;
    }
    return false;
  }

  // The next row of a section, as words, without its comment.
  const Words& next_row(const char* section, std::uint64_t row, std::uint64_t rows) {
    const auto expected = [&] {
      return "row " + std::to_string(row + 1) + " of " + std::to_string(rows) + " of \"" + section + "\"";
    };
    do {
      if (!lines_.next()) lines_.fail_at_end(expected());
      if (is_section_title(lines_)) lines_.fail(quoted(lines_.line()) + ", expected " + expected());
      split_words(without_comment(lines_.line()), row_);
    } while (row_.empty());
    return row_;
  }

  void check_columns(std::size_t least, const char* what) const {
    if (row_.size() < least) lines_.fail(std::to_string(row_.size()) + " columns, expected " + what);
  }

  // Labels in `text` are replaced by their numbers.
  std::int64_t read_type(std::string_view& text) const {
    if (const auto found = type_labels_.find(text); found != type_labels_.end()) text = found->second;
    std::int64_t type = 0;
    if (!parse_whole(text, type)) lines_.fail(quoted(text) + ", expected the number of an atom type");
    if (type < 1 || type > header_.types) {
      lines_.fail("type " + std::to_string(type) + ", but the header says " + std::to_string(header_.types) +
                  " atom types");
    }
    return type;
  }

  void read_type_labels() {
    const auto types = static_cast<std::uint64_t>(header_.types);
    for (std::uint64_t i = 0; i < types; ++i) {
      next_row("Atom Type Labels", i, types);
      check_columns(2, "a type and its label");
      type_labels_.emplace(std::string(row_[1]), std::string(row_[0]));
    }
  }

  void read_masses() {
    const auto types = static_cast<std::uint64_t>(header_.types);
    for (std::uint64_t i = 0; i < types; ++i) {
      next_row("Masses", i, types);
      check_columns(2, "a type and its mass");
      masses_[read_type(row_[0])] = number_in(lines_, row_[1]);
    }
  }

  void choose_style() {
    const std::string hint = style_name_.empty() ? std::string(comment_of(lines_.line())) : style_name_;
    style_ = atom_style_named(hint);
    if (!style_.columns.empty()) return;
    if (!style_name_.empty()) {
      throw InputError(lines_.path(), 0,
                       "atom style " + quoted(style_name_) + " is not known, expected one of " + atom_style_names());
    }
    const std::vector<TextRow> rows = rows_behind(lines_.path(), lines_.line_number(), header_.atoms);
    if (rows.empty()) return;
    style_ = guess_atom_style(rows, header_.types);
    if (style_.columns.empty()) {
      lines_.fail("rows of " + std::to_string(rows[0].size()) +
                  " columns fit no atom style, expected a hint such as \"Atoms # full\" (or --atom-style)");
    }
  }

  void read_atoms(Frame& frame) {
    if (std::exchange(atoms_read_, true)) lines_.fail("a second section \"Atoms\", expected one");
    choose_style();
    ColumnReader columns(columns_of(style_));
    columns.begin(frame);
    const auto type_place = static_cast<std::size_t>(std::find(style_.columns.begin(), style_.columns.end(), "type") -
                                                     style_.columns.begin());
    for (std::uint64_t i = 0; i < header_.atoms; ++i) {
      next_row("Atoms", i, header_.atoms);
      const std::size_t size = style_.columns.size();
      if (row_.size() != size && row_.size() != size + 3) {
        lines_.fail(std::to_string(row_.size()) + " columns, expected " + std::to_string(size) + " or " +
                    std::to_string(size + 3) + " for atom style " + style_.name);
      }
      read_type(row_[type_place]);
      columns.read_row(row_, lines_, frame);
    }
  }

  // Sections beside "Atoms" name their particles by id, in an order of their own.
  std::size_t particle_of_id(const Frame& frame, const char* section) {
    if (!atoms_read_) lines_.fail(std::string("\"") + section + "\" before \"Atoms\"");
    if (place_of_id_.empty()) {
      const std::vector<double>& ids = frame.find("id")->values();
      for (std::size_t i = 0; i < ids.size(); ++i) place_of_id_[ids[i]] = i;
    }
    std::int64_t id = 0;
    if (!parse_whole(row_[0], id)) lines_.fail(quoted(row_[0]) + ", expected the id of an atom");
    const auto found = place_of_id_.find(static_cast<double>(id));
    if (found == place_of_id_.end()) lines_.fail("no atom has the id " + std::to_string(id));
    return found->second;
  }

  void read_velocities(Frame& frame) {
    Attribute velocity{"velocity", 3, false, std::vector<double>(3 * frame.count())};
    for (std::uint64_t i = 0; i < header_.atoms; ++i) {
      next_row("Velocities", i, header_.atoms);
      check_columns(4, "an id and three components");
      const std::size_t particle = particle_of_id(frame, "Velocities");
      for (std::size_t c = 0; c < 3; ++c) velocity.values()[3 * particle + c] = number_in(lines_, row_[c + 1]);
    }
    frame.remove("velocity");
    frame.attributes.push_back(std::move(velocity));
  }

  // Ellipsoids are drawn as spheres of their volume; particles without a shape are points and stay invisible.
  void read_ellipsoids(Frame& frame) {
    Attribute radius{"radius", 1, false, std::vector<double>(frame.count())};
    for (std::uint64_t i = 0; i < header_.ellipsoids; ++i) {
      next_row("Ellipsoids", i, header_.ellipsoids);
      check_columns(8, "an id, three diameters and a quaternion");
      const std::size_t particle = particle_of_id(frame, "Ellipsoids");
      double volume = 1.0;
      for (std::size_t c = 0; c < 3; ++c) volume *= number_in(lines_, row_[c + 1]);
      radius.values()[particle] = std::cbrt(volume) / 2;
    }
    frame.remove("radius");
    frame.attributes.push_back(std::move(radius));
  }

  // By the masses of the types. In an electron force field the particles of spin +-1 are electrons, whatever their
  // type.
  void add_elements(Frame& frame) const {
    if (masses_.empty() || static_cast<std::int64_t>(masses_.size()) != header_.types) return;
    std::vector<double> masses;
    for (const auto& [type, mass] : masses_) masses.push_back(mass);
    assign_elements(frame, elements_of_masses(masses));
    Attribute* const element = frame.find("element");
    const Attribute* const spin = style_.name == "electron" ? frame.find("spin") : nullptr;
    if (!element || !spin) return;
    for (std::size_t i = 0; i < spin->values().size(); ++i) {
      if (std::abs(spin->values()[i]) == 1.0) element->values()[i] = 0.0;
    }
  }

  LineReader lines_;
  std::string style_name_;
  DataHeader header_;
  AtomStyle style_;
  Words row_;
  std::map<std::string, std::string, std::less<>> type_labels_;
  std::map<std::int64_t, double> masses_;
  std::unordered_map<double, std::size_t> place_of_id_;
  bool atoms_read_ = false;
  bool done_ = false;
};

}  // namespace

std::unique_ptr<FrameReader> open_lammps_data(const std::string& path, const ReadOptions& options) {
  return std::make_unique<DataReader>(path, options);
}

}  // namespace replay
