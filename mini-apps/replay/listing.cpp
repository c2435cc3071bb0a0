#include "listing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <ostream>
#include <set>
#include <vector>

#include "elements.h"
#include "frame.h"
#include "reader.h"

namespace replay {
namespace {

struct Range {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();
  std::uint64_t not_finite = 0;

  void add(double value) {
    if (!std::isfinite(value)) {
      ++not_finite;
      return;
    }
    lower = std::min(lower, value);
    upper = std::max(upper, value);
  }
  void add(const Range& other) {
    lower = std::min(lower, other.lower);
    upper = std::max(upper, other.upper);
    not_finite += other.not_finite;
  }
};

std::string number_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string range_text(const Range& range) {
  std::string text = range.lower <= range.upper ? number_text(range.lower) + " to " + number_text(range.upper) : "none";
  if (range.not_finite > 0) text += " (" + std::to_string(range.not_finite) + " not finite)";
  return text;
}

template <class T>
std::string span_text(T lowest, T highest) {
  return lowest == highest ? std::to_string(lowest) : std::to_string(lowest) + " to " + std::to_string(highest);
}

// What the steps of a file have in common, and between which values they vary.
struct Summary {
  std::uint64_t frames = 0;
  std::uint64_t fewest = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t most = 0;
  std::optional<std::uint64_t> first_number;
  std::optional<std::uint64_t> last_number;
  Box box;  // of the first step that has one
  Range bounds[3];
  std::vector<std::pair<std::string, Range>> attributes;  // in the order in which they first appear
  std::set<int> elements;

  void add(const Frame& frame) {
    ++frames;
    fewest = std::min<std::uint64_t>(fewest, frame.count());
    most = std::max<std::uint64_t>(most, frame.count());
    if (frame.step && !first_number) first_number = frame.step;
    if (frame.step) last_number = frame.step;
    if (!box.known) box = frame.box;
    for (std::size_t i = 0; i < frame.position.size(); ++i) bounds[i % 3].add(frame.position[i]);
    for (const Attribute& attribute : frame.attributes) add(attribute);
  }

 private:
  void add(const Attribute& attribute) {
    Range range[4];
    for_each_value(attribute.scalars, [&](std::size_t i, double value) { range[i % attribute.components].add(value); });
    for (std::uint32_t c = 0; c < attribute.components; ++c) {
      std::string name = attribute.name;
      if (attribute.components > 1) name.append(".").append(1, "xyzw"[c]);
      range_of(name).add(range[c]);
    }
    if (attribute.name != "element") return;
    for_each_value(attribute.scalars, [this](std::size_t, double z) { elements.insert(atomic_number_of(z)); });
  }
  Range& range_of(const std::string& name) {
    for (auto& [known, range] : attributes) {
      if (known == name) return range;
    }
    return attributes.emplace_back(name, Range()).second;
  }
};

void print_box(std::ostream& out, const Box& box) {
  const auto vector_text = [](const std::array<double, 3>& v) {
    char text[120];
    std::snprintf(text, sizeof text, "(%.6g, %.6g, %.6g)", v[0], v[1], v[2]);
    return std::string(text);
  };
  out << "  box         " << vector_text(box.edge[0]) << ' ' << vector_text(box.edge[1]) << ' '
      << vector_text(box.edge[2]) << " from " << vector_text(box.origin) << '\n';
}

void print_summary(std::ostream& out, const Summary& summary) {
  if (summary.frames == 0) return;
  out << "  particles   " << span_text(summary.fewest, summary.most) << '\n';
  if (summary.box.known) print_box(out, summary.box);
  for (std::size_t i = 0; i < 3; ++i)
    out << "  "
        << "xyz"[i] << "           " << range_text(summary.bounds[i]) << '\n';
  if (summary.attributes.empty()) return;
  out << "  attributes\n";
  for (const auto& [name, range] : summary.attributes) {
    std::string padded = name;
    padded.resize(std::max<std::size_t>(padded.size(), 16), ' ');
    out << "    " << padded << ' ' << range_text(range);
    if (name == "element") {
      out << " (";
      bool first = true;
      for (const int z : summary.elements) {
        out << (first ? "" : " ") << element_symbol(z);
        first = false;
      }
      out << ')';
    }
    out << '\n';
  }
}

}  // namespace

std::uint64_t print_listing(std::ostream& out, const std::string& path, const Options& options,
                            std::uint64_t first_step) {
  const Format format = options.read.format ? *options.read.format : detect_format(path);
  ReadOptions read = options.read;
  read.format = format;
  const auto reader = open_reader(path, read);
  Summary summary;
  Frame frame;
  std::uint64_t step = first_step;
  while (!options.steps.is_behind(step) && reader->next(frame)) {
    if (!options.elements.empty()) assign_elements(frame, options.elements);
    if (options.steps.contains(step)) summary.add(frame);
    ++step;
  }
  out << path << ": " << format_title(format);
  if (!reader->remark().empty()) out << ", " << reader->remark();
  for (const std::string& trajectory : read.trajectories) out << "\n  moved by    " << trajectory;
  out << "\n  steps       " << summary.frames;
  if (summary.first_number) out << ", numbered " << span_text(*summary.first_number, *summary.last_number);
  out << '\n';
  print_summary(out, summary);
  return step;
}

}  // namespace replay
