#include "cif_block.h"

#include <gemmi/numb.hpp>

#include <algorithm>
#include <string>
#include <utility>

#include "input_error.h"
#include "numbers.h"

namespace replay {
namespace {

bool starts_with_ignoring_case(std::string_view text, std::string_view start) {
  return text.size() >= start.size() && equal_ignoring_case(text.substr(0, start.size()), start);
}

// Deposited structures hold far more than atoms, and their text may be larger than the atoms themselves.
bool is_needed(std::string_view tag) {
  if (starts_with_ignoring_case(tag, "_atom_site_aniso")) return false;
  for (const char* start : {"_atom_site.", "_atom_site_", "_cell", "_symmetry", "_space_group"}) {
    if (starts_with_ignoring_case(tag, start)) return true;
  }
  return false;
}

bool is_coordinate(std::string_view tag) {
  for (const char* name : {"_atom_site.cartn_", "_atom_site_fract_"}) {
    if (starts_with_ignoring_case(tag, name)) return true;
  }
  return false;
}

// Words of CIF: tags, values (quotes kept, as gemmi wants them), and the reserved words.
class Lexer {
 public:
  explicit Lexer(LineReader& lines) : lines_(lines) {}

  // False at the end of the file. The word is in text(); is_bare() when it was not quoted.
  bool next() {
    while (true) {
      while (at_ < line_.size() && is_blank(line_[at_])) ++at_;
      if (at_ == line_.size() || line_[at_] == '#') {
        if (!lines_.next()) return false;
        line_ = lines_.line();
        at_ = 0;
        if (!line_.empty() && line_[0] == ';') {
          read_text_field();
          return true;
        }
        continue;
      }
      const char c = line_[at_];
      bare_ = c != '\'' && c != '"';
      bare_ ? read_bare() : read_quoted(c);
      return true;
    }
  }

  const std::string& text() const { return text_; }
  bool is_bare() const { return bare_; }
  bool is_tag() const { return bare_ && text_[0] == '_'; }
  bool is_word(std::string_view word) const { return bare_ && equal_ignoring_case(text_, word); }
  bool starts_block() const { return bare_ && starts_with_ignoring_case(text_, "data_"); }
  bool is_value() const {
    return !is_tag() && !is_word("loop_") && !starts_block() && !(bare_ && starts_with_ignoring_case(text_, "save_"));
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t'; }

  void read_bare() {
    const std::size_t end = std::min(line_.find_first_of(" \t", at_), line_.size());
    text_ = line_.substr(at_, end - at_);
    at_ = end;
  }
  // A quote ends where a blank follows it: 'O5'' is one value.
  void read_quoted(char quote) {
    std::size_t end = at_ + 1;
    while (end < line_.size() && !(line_[end] == quote && (end + 1 == line_.size() || is_blank(line_[end + 1])))) ++end;
    if (end == line_.size()) lines_.fail(std::string("a value is not closed, expected ") + quote);
    text_ = line_.substr(at_, end + 1 - at_);
    at_ = end + 1;
  }
  // From a semicolon at the start of a line to the next one.
  void read_text_field() {
    bare_ = false;
    text_ = line_;
    do {
      if (!lines_.next()) lines_.fail_at_end("a line that starts with \";\" and closes the text");
      text_ += '\n';
      text_ += lines_.line().substr(0, 1) == ";" ? ";" : lines_.line();
    } while (lines_.line().substr(0, 1) != ";");
    line_ = lines_.line();
    at_ = 1;
  }

  LineReader& lines_;
  std::string_view line_;
  std::size_t at_ = 0;
  std::string text_;
  bool bare_ = true;
};

void check_coordinate(const std::string& tag, const Lexer& lexer, const LineReader& lines) {
  const std::string& text = lexer.text();
  double value = 0.0;
  if (text == "?" || text == "." || parse_number(text, value) || gemmi::cif::is_numb(text)) return;
  lines.fail(quoted(text) + " as " + tag + ", expected a number");
}

// Called at "loop_"; leaves the lexer at the first word behind the loop, and returns false at the end of the file.
bool read_loop(Lexer& lexer, LineReader& lines, gemmi::cif::Block& block) {
  gemmi::cif::Item item(gemmi::cif::LoopArg{});
  item.line_number = static_cast<int>(lines.line_number());
  bool more = lexer.next();
  for (; more && lexer.is_tag(); more = lexer.next()) item.loop.tags.push_back(lexer.text());
  const std::size_t width = item.loop.tags.size();
  if (width == 0) lines.fail("\"loop_\" without tags, expected names such as \"_atom_site.Cartn_x\"");
  const bool needed = is_needed(item.loop.tags[0]);
  std::vector<bool> coordinate;
  for (const std::string& tag : item.loop.tags) coordinate.push_back(needed && is_coordinate(tag));
  std::size_t column = 0;
  for (; more && lexer.is_value(); more = lexer.next()) {
    if (coordinate[column]) check_coordinate(item.loop.tags[column], lexer, lines);
    if (needed) item.loop.values.push_back(lexer.text());
    column = column + 1 == width ? 0 : column + 1;
  }
  if (column != 0) {
    lines.fail("the loop that starts in line " + std::to_string(item.line_number) + " ends inside of a row, expected " +
               std::to_string(width) + " values in each");
  }
  if (needed) block.items.push_back(std::move(item));
  return more;
}

}  // namespace

gemmi::cif::Block read_cif_block(LineReader& lines) {
  Lexer lexer(lines);
  if (!lexer.next()) lines.fail_at_end("\"data_\"");
  if (!lexer.starts_block()) lines.fail(quoted(lexer.text()) + ", expected \"data_\" and a name");
  gemmi::cif::Block block(lexer.text().substr(5));
  bool more = lexer.next();
  while (more && !lexer.starts_block()) {
    if (lexer.is_word("loop_")) {
      more = read_loop(lexer, lines, block);
      continue;
    }
    if (!lexer.is_tag()) lines.fail(quoted(lexer.text()) + ", expected a tag such as \"_cell.length_a\" or \"loop_\"");
    const std::string tag = lexer.text();
    more = lexer.next();
    if (!more) lines.fail_at_end("the value of " + tag);
    if (!lexer.is_value()) lines.fail(quoted(lexer.text()) + ", expected the value of " + tag);
    if (is_coordinate(tag)) check_coordinate(tag, lexer, lines);
    if (is_needed(tag)) {
      gemmi::cif::Item item(tag, lexer.text());
      item.line_number = static_cast<int>(lines.line_number());
      block.items.push_back(std::move(item));
    }
    more = lexer.next();
  }
  return block;
}

}  // namespace replay
