#include "atom_styles.h"

#include <algorithm>
#include <array>

#include "numbers.h"

namespace replay {
namespace {

struct StyleText {
  const char* name;
  const char* columns;
};

// As the LAMMPS manual lists them for read_data. Radii that a style gives per particle are called "radius" whatever
// their name there, so that they are drawn.
constexpr StyleText styles[] = {
    {"angle", "id mol type x y z"},
    {"atomic", "id type x y z"},
    {"body", "id type bodyflag mass x y z"},
    {"bond", "id mol type x y z"},
    {"bpm/sphere", "id mol type diameter density x y z"},
    {"charge", "id type q x y z"},
    {"dielectric", "id type q x y z nx ny nz area ed em epsilon curvature"},
    {"dipole", "id type q x y z mux muy muz"},
    {"dpd", "id type theta x y z"},
    {"edpd", "id type temperature cv x y z"},
    {"electron", "id type q spin radius x y z"},
    {"ellipsoid", "id type ellipsoidflag density x y z"},
    {"full", "id mol type q x y z"},
    {"line", "id mol type lineflag density x y z"},
    {"mdpd", "id type rho x y z"},
    {"mesont", "id mol type bond1 bond2 mass radius length buckled x y z"},
    {"molecular", "id mol type x y z"},
    {"peri", "id type volume density x y z"},
    {"smd", "id type mol volume mass kradius radius x0 y0 z0 x y z"},
    {"sph", "id type rho esph cv x y z"},
    {"sphere", "id type diameter density x y z"},
    {"spin", "id type x y z spx spy spz sp"},
    {"template", "id type mol template template_atom x y z"},
    {"tri", "id mol type triangleflag density x y z"},
    {"wavepacket", "id type q spin radius etag cs_re cs_im x y z"},
};

// The ones to guess, the likelier first where several have as many columns.
constexpr std::array<const char*, 11> guesses = {"atomic", "molecular", "charge", "full", "sphere",    "electron",
                                                 "sph",    "dipole",    "mesont", "smd",  "bpm/sphere"};

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  split_words(text, words);
  return {words.begin(), words.end()};
}

// A hybrid style starts as the atomic one; then come, style by style, the columns that were not there before.
std::vector<std::string> hybrid_columns(const std::vector<std::string>& names) {
  std::vector<std::string> columns = words_of("id type x y z");
  for (std::size_t i = 1; i < names.size(); ++i) {
    const AtomStyle style = atom_style_named(names[i]);
    if (style.columns.empty()) return {};
    for (const std::string& column : style.columns) {
      if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
    }
  }
  return columns;
}

bool row_fits(const TextRow& row, const AtomStyle& style, std::int64_t type_count) {
  if (row.size() != style.columns.size() + (style.image_flags ? 3 : 0)) return false;
  for (std::size_t i = 0; i < row.size(); ++i) {
    double number = 0.0;
    std::int64_t whole = 0;
    if (!parse_number(row[i], number)) return false;
    const bool is_flag = i >= style.columns.size();
    if ((is_flag || is_whole_column(style.columns[i])) && !parse_whole(row[i], whole)) return false;
    if (!is_flag && style.columns[i] == "type" && (whole < 1 || whole > type_count)) return false;
  }
  return true;
}

}  // namespace

AtomStyle atom_style_named(std::string_view name) {
  const std::vector<std::string> names = words_of(name);
  AtomStyle style;
  style.name = name;
  if (names.size() > 1 && names[0] == "hybrid") {
    style.columns = hybrid_columns(names);
    return style;
  }
  if (name == "meso") name = "sph";
  if (name == "meso/sph") name = "sph";
  for (const StyleText& known : styles) {
    if (name == known.name) style.columns = words_of(known.columns);
  }
  return style;
}

std::string atom_style_names() {
  std::string names;
  for (const StyleText& style : styles) names += std::string(style.name) + ", ";
  return names + "\"hybrid STYLE...\"";
}

AtomStyle guess_atom_style(const std::vector<TextRow>& rows, std::int64_t type_count) {
  // Image flags first: coordinates that are whole numbers throughout are rarer than image flags.
  for (const bool image_flags : {true, false}) {
    for (const char* name : guesses) {
      AtomStyle style = atom_style_named(name);
      style.image_flags = image_flags;
      style.guessed = true;
      if (std::all_of(rows.begin(), rows.end(), [&](const TextRow& row) { return row_fits(row, style, type_count); })) {
        return style;
      }
    }
  }
  return {};
}

bool is_whole_column(std::string_view name) {
  constexpr std::array<std::string_view, 12> whole = {"id",       "mol",          "type",          "bodyflag",
                                                      "lineflag", "triangleflag", "ellipsoidflag", "spin",
                                                      "bond1",    "bond2",        "buckled",       "template"};
  return std::find(whole.begin(), whole.end(), name) != whole.end();
}

}  // namespace replay
