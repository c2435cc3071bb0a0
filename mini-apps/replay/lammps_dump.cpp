// LAMMPS text dumps (dump custom, dump atom): any columns, any number of steps, particles in any order.
#include <algorithm>
#include <array>
#include <utility>

#include "columns.h"
#include "input_error.h"
#include "numbers.h"
#include "reader.h"

namespace replay {
namespace {

constexpr std::array<const char*, 3> axis_names = {"x", "y", "z"};

// The four ways in which a dump writes positions: wrapped into the box or not, in length units or scaled by the box.
struct PositionStyle {
  const char* suffix;
  bool scaled;
};
constexpr std::array<PositionStyle, 4> position_styles = {{{"", false}, {"u", false}, {"s", true}, {"su", true}}};

class DumpReader : public FrameReader {
 public:
  explicit DumpReader(const std::string& path) : lines_(path) {}

  bool next(Frame& frame) override {
    frame = Frame();
    if (!lines_.next_filled()) {
      if (frames_ == 0) lines_.fail_at_end("\"ITEM: TIMESTEP\"");
      return false;
    }
    lines_.unread();
    std::optional<std::uint64_t> count;
    while (true) {
      if (!lines_.next_filled()) lines_.fail_at_end("the next \"ITEM: ...\" of the step");
      const std::string_view line = lines_.line();
      if (line.substr(0, 6) != "ITEM: ") {
        lines_.fail(quoted(line) + ", expected \"ITEM: ...\"" +
                    (frames_ > 0 && !count ? " (does the step before have more atoms than it says?)" : ""));
      }
      const std::string_view item = line.substr(6);
      if (item.substr(0, 8) == "TIMESTEP") {
        frame.step = read_whole("the number of the step");
      } else if (item.substr(0, 4) == "TIME") {
        frame.time = read_time();
      } else if (item.substr(0, 15) == "NUMBER OF ATOMS") {
        count = read_whole("the number of atoms");
      } else if (item.substr(0, 10) == "BOX BOUNDS") {
        read_box(frame.box);
      } else if (item.substr(0, 5) == "ATOMS") {
        if (!count) lines_.fail("\"ITEM: ATOMS\" comes before \"ITEM: NUMBER OF ATOMS\"");
        read_atoms(*count, frame);
        break;
      } else {
        // Of other items ("UNITS", and what later versions add) only the one line that follows is passed over.
        next_line("the value of " + quoted(line));
      }
    }
    ++frames_;
    derive_attributes(frame);
    return true;
  }

 private:
  void next_line(const std::string& expected) {
    if (!lines_.next_filled()) lines_.fail_at_end(expected);
  }

  std::uint64_t read_whole(const std::string& what) {
    next_line(what);
    std::int64_t value = 0;
    if (!parse_whole(lines_.words()[0], value) || value < 0) lines_.fail(quoted(lines_.line()) + ", expected " + what);
    return static_cast<std::uint64_t>(value);
  }

  double read_time() {
    next_line("the time of the step");
    double value = 0.0;
    if (!parse_number(lines_.words()[0], value)) lines_.fail(quoted(lines_.line()) + ", expected a time");
    return value;
  }

  // Three lines: bounds and tilts, or with "abc origin" the edges and one component of the corner.
  void read_box(Box& box) {
    const std::string_view item = lines_.line();
    const bool general = item.find("abc origin") != std::string_view::npos;
    const bool tilted = item.find("xy xz yz") != std::string_view::npos;
    const std::size_t columns = general ? 4 : (tilted ? 3 : 2);
    double value[3][4] = {};
    for (auto& row : value) {
      next_line("the bounds of the box");
      const auto& words = lines_.words();
      bool good = words.size() >= columns;
      for (std::size_t c = 0; good && c < columns; ++c) good = parse_number(words[c], row[c]);
      if (!good) {
        lines_.fail(quoted(lines_.line()) + " as bounds of the box, expected " + std::to_string(columns) + " numbers");
      }
    }
    if (general) {
      box.known = true;
      for (std::size_t k = 0; k < 3; ++k) {
        box.edge[k] = {value[k][0], value[k][1], value[k][2]};
        box.origin[k] = value[k][3];
      }
      return;
    }
    // The bounds are those of the tilted box's bounding box; the corner of the box itself lies inside.
    const double xy = value[0][2];
    const double xz = value[1][2];
    const double yz = value[2][2];
    const std::array<double, 3> lower = {value[0][0] - std::min({0.0, xy, xz, xy + xz}),
                                         value[1][0] - std::min(0.0, yz), value[2][0]};
    const std::array<double, 3> upper = {value[0][1] - std::max({0.0, xy, xz, xy + xz}),
                                         value[1][1] - std::max(0.0, yz), value[2][1]};
    box = Box::from_bounds(lower, upper, xy, xz, yz);
  }

  // Columns may change from step to step; categories keep their numbers as long as they do not.
  void read_columns() {
    std::string header(lines_.line());
    if (header == header_) return;
    std::vector<std::string> names(lines_.words().begin() + 2, lines_.words().end());
    const PositionStyle* style = nullptr;
    std::array<std::size_t, 3> place = {};
    for (const PositionStyle& candidate : position_styles) {
      bool all = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto found = std::find(names.begin(), names.end(), std::string(axis_names[k]) + candidate.suffix);
        place[k] = static_cast<std::size_t>(found - names.begin());
        all = all && found != names.end();
      }
      if (all) {
        style = &candidate;
        break;
      }
    }
    if (!style) {
      lines_.fail("no columns with positions in " + quoted(header) +
                  ", expected x y z, xu yu zu, xs ys zs or xsu ysu zsu");
    }
    std::vector<Column> columns;
    for (std::size_t i = 0; i < names.size(); ++i) {
      Column column;
      column.name = names[i];
      const auto axis = std::find(place.begin(), place.end(), i);
      if (axis != place.end()) {
        column.kind = Column::Kind::position;
        column.component = static_cast<std::uint32_t>(axis - place.begin());
      } else if (names[i] == "element") {
        column.kind = Column::Kind::element;
      } else {
        column.kind = Column::Kind::number;
        column.categorical = names[i] == "type" || names[i] == "mol";
      }
      columns.push_back(std::move(column));
    }
    columns_ = ColumnReader(std::move(columns));
    label_columns_known_ = false;
    scaled_ = style->scaled;
    header_ = std::move(header);
    names_ = std::move(names);
  }

  void read_atoms(std::uint64_t count, Frame& frame) {
    read_columns();
    if (scaled_ && !frame.box.known) lines_.fail("scaled positions need \"ITEM: BOX BOUNDS\" before them");
    columns_.begin(frame);
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto expected = [&] { return "atom " + std::to_string(i + 1) + " of " + std::to_string(count); };
      if (!lines_.next_filled()) lines_.fail_at_end(expected());
      if (lines_.words()[0] == "ITEM:") lines_.fail(quoted(lines_.line()) + ", expected " + expected());
      if (lines_.words().size() != columns_.size()) {
        lines_.fail(std::to_string(lines_.words().size()) + " columns, expected " + std::to_string(columns_.size()));
      }
      if (!label_columns_known_) look_for_labels(frame);
      columns_.read_row(lines_.words(), lines_, frame);
    }
    if (!scaled_) return;
    for (std::size_t i = 0; i < frame.position.size(); i += 3) {
      double* const p = &frame.position[i];
      const auto at = frame.box.from_scaled(p[0], p[1], p[2]);
      std::copy(at.begin(), at.end(), p);
    }
  }

  // A "type" column holds numbers or, in newer dumps, names; the first row tells.
  void look_for_labels(Frame& frame) {
    label_columns_known_ = true;
    const auto type = std::find(names_.begin(), names_.end(), "type");
    if (type == names_.end()) return;
    const auto place = static_cast<std::size_t>(type - names_.begin());
    double number = 0.0;
    if (parse_number(lines_.words()[place], number)) return;
    columns_.set_kind(place, Column::Kind::species);
    columns_.begin(frame);
  }

  LineReader lines_;
  std::uint64_t frames_ = 0;
  std::string header_;
  std::vector<std::string> names_;
  ColumnReader columns_{{}};
  bool scaled_ = false;
  bool label_columns_known_ = false;
};

}  // namespace

std::unique_ptr<FrameReader> open_lammps_dump(const std::string& path) { return std::make_unique<DumpReader>(path); }

}  // namespace replay
