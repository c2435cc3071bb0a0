#include "columns.h"

#include <algorithm>
#include <utility>

#include "elements.h"
#include "input_error.h"
#include "numbers.h"

namespace replay {
namespace {

std::size_t attribute_place(Frame& frame, const std::string& name, std::uint32_t components, bool categorical) {
  for (std::size_t i = 0; i < frame.attributes.size(); ++i) {
    if (frame.attributes[i].name == name) return i;
  }
  frame.add(name, components, categorical);
  return frame.attributes.size() - 1;
}

double element_of(std::string_view text) {
  std::int64_t number = 0;
  if (parse_whole(text, number)) return number > 0 && number <= element_count ? static_cast<double>(number) : 0.0;
  return element_of_symbol(text);
}

double number_of(const Column& column, std::string_view text, const LineReader& lines) {
  double value = 0.0;
  if (!parse_number(text, value)) {
    lines.fail(quoted(text) + " in column \"" + column.name + "\", expected a number");
  }
  std::int64_t whole = 0;
  if (column.whole && !parse_whole(text, whole)) {
    lines.fail(quoted(text) + " in column \"" + column.name + "\", expected a whole number");
  }
  return value;
}

double truth_of(const Column& column, std::string_view text, const LineReader& lines) {
  for (const std::string_view yes : {"T", "TRUE", "1"}) {
    if (equal_ignoring_case(text, yes)) return 1.0;
  }
  for (const std::string_view no : {"F", "FALSE", "0"}) {
    if (equal_ignoring_case(text, no)) return 0.0;
  }
  lines.fail(quoted(text) + " in column \"" + column.name + "\", expected T or F");
}

}  // namespace

ColumnReader::ColumnReader(std::vector<Column> columns) : columns_(std::move(columns)) { drop_duplicates(); }

void ColumnReader::set_kind(std::size_t column, Column::Kind kind) {
  columns_[column].kind = kind;
  drop_duplicates();
}

// An attribute needs one value per particle and component, so no two columns may feed the same.
void ColumnReader::drop_duplicates() {
  struct Claim {
    std::string name;
    std::uint32_t component;
    std::uint32_t components;
  };
  std::vector<Claim> claims;
  const auto free_for = [&claims](const std::string& name, const Column& column) {
    return std::none_of(claims.begin(), claims.end(), [&](const Claim& claim) {
      return claim.name == name && (claim.component == column.component || claim.components != column.components);
    });
  };
  for (Column& column : columns_) {
    if (column.kind == Column::Kind::position) continue;
    if (column.kind == Column::Kind::species) {
      const bool element = free_for("element", column);
      const bool type = free_for("type", column);
      if (element && type) {
        claims.push_back({"element", 0, 1});
        claims.push_back({"type", 0, 1});
        continue;
      }
      column.kind = element ? Column::Kind::element : Column::Kind::category;
      column.name = "type";
    }
    if (column.kind == Column::Kind::element) column.name = "element";
    if (column.kind != Column::Kind::skip && !free_for(column.name, column)) column.kind = Column::Kind::skip;
    if (column.kind != Column::Kind::skip) claims.push_back({column.name, column.component, column.components});
  }
}

void ColumnReader::begin(Frame& frame) {
  frame.position.clear();
  frame.attributes.clear();
  target_.assign(columns_.size(), 0);
  categories_.resize(columns_.size());
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column& column = columns_[i];
    switch (column.kind) {
      case Column::Kind::skip:
      case Column::Kind::position:
        break;
      case Column::Kind::number:
        target_[i] = attribute_place(frame, column.name, column.components, column.categorical);
        break;
      case Column::Kind::element:
        target_[i] = attribute_place(frame, "element", 1, true);
        break;
      case Column::Kind::category:
        target_[i] = attribute_place(frame, column.name, 1, true);
        break;
      case Column::Kind::species:
        target_[i] = attribute_place(frame, "element", 1, true);
        type_target_ = attribute_place(frame, "type", 1, true);
        break;
      case Column::Kind::truth:
        target_[i] = attribute_place(frame, column.name, column.components, true);
        break;
    }
  }
}

double ColumnReader::category(std::size_t column, std::string_view text) {
  auto& known = categories_[column];
  if (const auto found = known.find(text); found != known.end()) return found->second;
  const double number = static_cast<double>(known.size() + 1);
  known.emplace(std::string(text), number);
  return number;
}

void ColumnReader::read_row(const Words& words, const LineReader& lines, Frame& frame) {
  double position[3] = {};
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column& column = columns_[i];
    const std::string_view text = words[i];
    switch (column.kind) {
      case Column::Kind::skip:
        break;
      case Column::Kind::position:
        position[column.component] = number_of(column, text, lines);
        break;
      case Column::Kind::number:
        frame.attributes[target_[i]].values().push_back(number_of(column, text, lines));
        break;
      case Column::Kind::element:
        frame.attributes[target_[i]].values().push_back(element_of(text));
        break;
      case Column::Kind::category:
        frame.attributes[target_[i]].values().push_back(category(i, text));
        break;
      case Column::Kind::species:
        frame.attributes[target_[i]].values().push_back(element_of(text));
        frame.attributes[type_target_].values().push_back(category(i, text));
        break;
      case Column::Kind::truth:
        frame.attributes[target_[i]].values().push_back(truth_of(column, text, lines));
        break;
    }
  }
  frame.position.insert(frame.position.end(), position, position + 3);
}

}  // namespace replay
