// XYZ files, plain and extended: a count, a comment line, then one line per particle; any number of steps.
#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "columns.h"
#include "input_error.h"
#include "numbers.h"
#include "reader.h"

namespace replay {
namespace {

using Pairs = std::map<std::string, std::string, std::less<>>;

char closing_of(char opening) {
  switch (opening) {
    case '"':
    case '\'':
      return opening;
    case '{':
      return '}';
    case '[':
      return ']';
    default:
      return '\0';
  }
}

// The key=value pairs of an extended comment line; values may be quoted. Anything else on the line is passed over.
Pairs pairs_of(std::string_view line) {
  Pairs pairs;
  std::size_t at = 0;
  while (at < line.size()) {
    const std::size_t begin = line.find_first_not_of(" \t", at);
    if (begin == std::string_view::npos) break;
    const std::size_t end = std::min(line.find_first_of(" \t=", begin), line.size());
    if (end == line.size() || line[end] != '=') {
      at = end + 1;
      continue;
    }
    const std::string key(line.substr(begin, end - begin));
    std::size_t value_begin = end + 1;
    std::size_t value_end = 0;
    const char closing = value_begin < line.size() ? closing_of(line[value_begin]) : '\0';
    if (closing != '\0') {
      value_end = std::min(line.find(closing, ++value_begin), line.size());
    } else {
      value_end = std::min(line.find_first_of(" \t", value_begin), line.size());
    }
    pairs[key] = line.substr(value_begin, value_end - value_begin);
    at = value_end + 1;
  }
  return pairs;
}

const std::string* find_pair(const Pairs& pairs, std::string_view key) {
  for (const auto& [name, value] : pairs) {
    if (equal_ignoring_case(name, key)) return &value;
  }
  return nullptr;
}

// "species:S:1:pos:R:3": name, kind and number of columns, again and again.
std::vector<Column> columns_of_properties(const std::string& properties, const LineReader& lines) {
  constexpr std::int64_t most_columns = 10000;
  std::vector<std::string> parts(1);
  for (const char c : properties) {
    if (c == ':') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (parts.size() % 3 != 0) lines.fail("Properties=" + quoted(properties) + ", expected name:kind:count triples");
  std::vector<Column> columns;
  bool positions = false;
  for (std::size_t i = 0; i < parts.size(); i += 3) {
    const std::string& name = parts[i];
    const std::string& kind = parts[i + 1];
    std::int64_t count = 0;
    if (!parse_whole(parts[i + 2], count) || count < 1 || count > most_columns || kind.size() != 1 ||
        std::string_view("SRIL").find(kind[0]) == std::string_view::npos) {
      lines.fail("property " + quoted(name + ":" + kind + ":" + parts[i + 2]) +
                 ", expected a kind S, R, I or L and a number of columns");
    }
    const bool is_position = equal_ignoring_case(name, "pos") && count == 3;
    positions = positions || is_position;
    for (std::int64_t c = 0; c < count; ++c) {
      Column column;
      column.name = name == "velo" || name == "vel" ? "velocity" : name;
      column.component = static_cast<std::uint32_t>(c);
      column.components = static_cast<std::uint32_t>(count);
      if (count > 4) {  // longer than a vector of the library: one attribute each
        column.name += '[';
        column.name += std::to_string(c + 1);
        column.name += ']';
        column.component = 0;
        column.components = 1;
      }
      column.kind = Column::Kind::number;
      column.categorical = name == "type" || name == "mol";
      if (is_position) column.kind = Column::Kind::position;
      if (kind == "L") column.kind = Column::Kind::truth;
      if (kind == "S") column.kind = count == 1 ? Column::Kind::category : Column::Kind::skip;
      if (kind == "S" && (name == "species" || name == "element")) column.kind = Column::Kind::species;
      if (kind == "I" && (name == "Z" || name == "numbers")) column.kind = Column::Kind::element;
      columns.push_back(std::move(column));
    }
  }
  if (!positions) lines.fail("no property pos:R:3 in " + quoted(properties));
  return columns;
}

// Without a description: a name, x, y, z, and whatever follows.
std::vector<Column> plain_columns(std::size_t size) {
  std::vector<Column> columns(size);
  columns[0].kind = Column::Kind::species;
  for (std::size_t i = 1; i < size; ++i) {
    Column& column = columns[i];
    column.kind = i <= 3 ? Column::Kind::position : Column::Kind::number;
    column.component = static_cast<std::uint32_t>(i <= 3 ? i - 1 : 0);
    column.name = i <= 3 ? std::string(1, "xyz"[i - 1]) : std::string("column_").append(std::to_string(i + 1));
  }
  return columns;
}

class XyzReader : public FrameReader {
 public:
  explicit XyzReader(const std::string& path) : lines_(path) {}

  bool next(Frame& frame) override {
    frame = Frame();
    if (!lines_.next_filled()) {
      if (frames_ == 0) lines_.fail_at_end("the number of particles");
      return false;
    }
    const std::uint64_t count = read_count();
    if (!lines_.next()) lines_.fail_at_end("a comment line");
    read_comment(frame);
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto expected = [&] { return "particle " + std::to_string(i + 1) + " of " + std::to_string(count); };
      if (!lines_.next()) lines_.fail_at_end(expected());
      if (lines_.words().empty()) lines_.fail("an empty line, expected " + expected());
      if (i == 0) begin_rows(frame);
      if (lines_.words().size() != columns_->size()) {
        lines_.fail(std::to_string(lines_.words().size()) + " columns, expected " + std::to_string(columns_->size()));
      }
      columns_->read_row(lines_.words(), lines_, frame);
    }
    ++frames_;
    derive_attributes(frame);
    return true;
  }

 private:
  std::uint64_t read_count() const {
    std::int64_t count = 0;
    if (lines_.words().size() != 1 || !parse_whole(lines_.words()[0], count) || count < 0) {
      lines_.fail(quoted(lines_.line()) + ", expected the number of particles");
    }
    return static_cast<std::uint64_t>(count);
  }

  void read_comment(Frame& frame) {
    const Pairs pairs = pairs_of(lines_.line());
    const std::string* const properties = find_pair(pairs, "Properties");
    const std::string described = properties ? *properties : std::string();
    // The same description as in the step before: categories keep their numbers.
    if (!columns_ || described != described_) {
      columns_.reset();
      if (properties) columns_.emplace(columns_of_properties(described, lines_));
    }
    described_ = described;
    if (const std::string* lattice = find_pair(pairs, "Lattice")) read_lattice(*lattice, frame.box);
    std::int64_t step = 0;
    if (const std::string* text = find_pair(pairs, "step"); text && parse_whole(*text, step) && step >= 0) {
      frame.step = static_cast<std::uint64_t>(step);
    }
    double time = 0.0;
    if (const std::string* text = find_pair(pairs, "time"); text && parse_number(*text, time)) frame.time = time;
  }

  void read_lattice(const std::string& text, Box& box) const {
    Words words;
    split_words(text, words);
    double value[9] = {};
    bool good = words.size() == 9;
    for (std::size_t i = 0; good && i < 9; ++i) good = parse_number(words[i], value[i]);
    if (!good) lines_.fail("Lattice=" + quoted(text) + ", expected nine numbers");
    box.known = true;
    for (std::size_t i = 0; i < 9; ++i) box.edge[i / 3][i % 3] = value[i];
  }

  void begin_rows(Frame& frame) {
    const std::size_t words = lines_.words().size();
    if (!columns_) {
      if (words < 4) lines_.fail(std::to_string(words) + " columns, expected a name and x, y, z");
      columns_.emplace(plain_columns(words));
    }
    columns_->begin(frame);
  }

  LineReader lines_;
  std::optional<ColumnReader> columns_;
  std::string described_;
  std::uint64_t frames_ = 0;
};

}  // namespace

std::unique_ptr<FrameReader> open_xyz(const std::string& path) { return std::make_unique<XyzReader>(path); }

}  // namespace replay
