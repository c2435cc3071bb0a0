#include "option_values.h"

#include <algorithm>
#include <cmath>

#include "elements.h"
#include "input_error.h"
#include "numbers.h"

namespace replay {
namespace {

using Vector = std::array<double, 3>;

std::vector<std::string> split_at(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::uint64_t step_number(const std::string& text, const std::string& whole_text) {
  std::int64_t value = 0;
  if (!parse_whole(text, value) || value < 0) {
    throw UsageError("--steps " + whole_text + ": " + quoted(text) +
                     " is no step, expected A:B:K, the steps A, A+K, ... below B, counted from 0");
  }
  return static_cast<std::uint64_t>(value);
}

double linear_of_srgb(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

constexpr std::pair<std::string_view, std::string_view> color_names[] = {
    {"white", "#ffffff"},  {"black", "#000000"}, {"grey", "#808080"},  {"gray", "#808080"},
    {"red", "#c03028"},    {"green", "#2f8f3f"}, {"blue", "#3060c0"},  {"yellow", "#e8c030"},
    {"orange", "#e08020"}, {"cyan", "#30a8b8"},  {"violet", "#8050b0"}};

}  // namespace

void parse_camera(const std::string& text, CameraOptions& camera) {
  const auto wrong = [&text](const std::string& why) {
    return UsageError("--camera " + text + ": " + why +
                      ", expected fit or eye=X,Y,Z,at=X,Y,Z,up=X,Y,Z,fov=DEGREES,height=H, each as needed");
  };
  if (text == "fit") return;
  // A part without "=" is one more number of the key before.
  std::vector<std::pair<std::string, std::vector<double>>> keys;
  for (const std::string& part : split_at(text, ',')) {
    const std::size_t equal = part.find('=');
    if (equal != std::string::npos) keys.push_back({part.substr(0, equal), {}});
    const std::string number_text = equal == std::string::npos ? part : part.substr(equal + 1);
    double number = 0.0;
    if (keys.empty()) throw wrong(quoted(part) + " has no key");
    if (!parse_number(number_text, number) || !std::isfinite(number))
      throw wrong(quoted(number_text) + " is no number");
    keys.back().second.push_back(number);
  }
  for (const auto& [key, numbers] : keys) {
    const bool is_vector = key == "eye" || key == "at" || key == "up";
    const bool is_number = key == "fov" || key == "height";
    if (!is_vector && !is_number) throw wrong(quoted(key) + " is no key");
    const std::size_t expected = is_vector ? 3 : 1;
    if (numbers.size() != expected) throw wrong(key + " needs " + (is_vector ? "three numbers" : "one number"));
    if (key == "eye") camera.eye = Vector{numbers[0], numbers[1], numbers[2]};
    if (key == "at") camera.at = Vector{numbers[0], numbers[1], numbers[2]};
    if (key == "up") camera.up = Vector{numbers[0], numbers[1], numbers[2]};
    if (is_number && !(numbers[0] > 0.0)) throw wrong(key + " must be above 0");
    if (key == "fov" && !(numbers[0] < 180.0)) throw wrong("fov must be below 180");
    if (key == "fov") camera.fov_deg = numbers[0];
    if (key == "height") camera.height = numbers[0];
  }
  if (camera.at && !camera.eye) throw wrong("at needs eye as well");
  if (camera.eye && camera.eye == camera.at) throw wrong("eye and at are the same");
}

void parse_view(const std::string& text, CameraOptions& camera) {
  struct Named {
    const char* name;
    Vector from;
    Vector up;
  };
  constexpr Named named[] = {{"x", {1, 0, 0}, {0, 0, 1}},     {"-x", {-1, 0, 0}, {0, 0, 1}},
                             {"y", {0, 1, 0}, {0, 0, 1}},     {"-y", {0, -1, 0}, {0, 0, 1}},
                             {"z", {0, 0, 1}, {0, 1, 0}},     {"-z", {0, 0, -1}, {0, 1, 0}},
                             {"iso", {1, -1.4, 1}, {0, 0, 1}}};
  Vector up = {0, 0, 1};
  const auto found = std::find_if(std::begin(named), std::end(named), [&](const Named& n) { return text == n.name; });
  if (found != std::end(named)) {
    camera.from = found->from;
    up = found->up;
  } else {
    const std::vector<std::string> parts = split_at(text, ',');
    bool good = parts.size() == 3;
    for (std::size_t i = 0; good && i < 3; ++i) {
      good = parse_number(parts[i], camera.from[i]) && std::isfinite(camera.from[i]);
    }
    if (!good || camera.from == Vector{0, 0, 0}) {
      throw UsageError("--view " + text + ": expected x, -x, y, -y, z, -z, iso or a direction such as 1,1,0.5");
    }
    // Seen from nearly above or below, y is the better direction upwards.
    const auto& [x, y, z] = camera.from;
    if (std::abs(z) > 0.98 * std::hypot(x, y, z)) up = {0, 1, 0};
  }
  if (!camera.up) camera.up = up;
}

std::pair<std::uint32_t, std::uint32_t> parse_size(const std::string& text) {
  constexpr std::int64_t largest = 32768;
  const std::vector<std::string> parts = split_at(text, 'x');
  std::int64_t size[2] = {};
  bool good = parts.size() == 2;
  for (std::size_t i = 0; good && i < 2; ++i)
    good = parse_whole(parts[i], size[i]) && size[i] > 0 && size[i] <= largest;
  if (!good) {
    throw UsageError("--size " + text + ": expected WIDTHxHEIGHT in pixels, such as 1920x1080, at most " +
                     std::to_string(largest) + " each");
  }
  return {static_cast<std::uint32_t>(size[0]), static_cast<std::uint32_t>(size[1])};
}

StepSelection parse_steps(const std::string& text) {
  const std::vector<std::string> parts = split_at(text, ':');
  StepSelection steps;
  if (!parts[0].empty() || parts.size() == 1) steps.first = step_number(parts[0], text);
  if (parts.size() == 1) steps.end = steps.first + 1;
  if (parts.size() > 1 && !parts[1].empty()) steps.end = step_number(parts[1], text);
  if (parts.size() > 2 && !parts[2].empty()) steps.stride = step_number(parts[2], text);
  if (parts.size() > 3 || steps.stride == 0 || (steps.end && *steps.end <= steps.first)) {
    throw UsageError("--steps " + text + ": selects nothing, expected A:B:K, the steps A, A+K, ... below B");
  }
  return steps;
}

std::array<std::uint32_t, 3> parse_replicate(const std::string& text) {
  constexpr std::int64_t most = 1000;
  const std::vector<std::string> parts = split_at(text, ',');
  std::array<std::uint32_t, 3> counts = {};
  bool good = parts.size() == 3;
  for (std::size_t i = 0; good && i < 3; ++i) {
    std::int64_t value = 0;
    good = parse_whole(parts[i], value) && value >= 1 && value <= most;
    counts[i] = static_cast<std::uint32_t>(value);
  }
  if (!good) throw UsageError("--replicate " + text + ": expected NX,NY,NZ, such as 2,2,1, each from 1 to 1000");
  return counts;
}

double parse_bonds(const std::string& text) {
  if (text == "auto") return 0.0;
  double value = 0.0;
  if (!parse_number(text, value) || !(value > 0.0 && std::isfinite(value))) {
    throw UsageError("--bonds " + text + ": expected auto, or a length above 0: the longest bond");
  }
  return value;
}

namespace {

// A function of one variable: straight lines between points, the first and the last value beyond them.
struct MapPoint {
  double at;
  double value;
};

// "A:V,A:V,..." in ascending order of A, where is_good(point). `expected` says so to the user.
template <class IsGood>
std::vector<MapPoint> parse_points(const std::string& option, const std::string& text, const std::string& expected,
                                   const IsGood& is_good) {
  const auto wrong = [&](const std::string& why) {
    return UsageError(option + " " + text + ": " + why + ", expected " + expected);
  };
  std::vector<MapPoint> points;
  for (const std::string& part : split_at(text, ',')) {
    const std::vector<std::string> numbers = split_at(part, ':');
    MapPoint point{};
    const bool good =
        numbers.size() == 2 && parse_number(numbers[0], point.at) && parse_number(numbers[1], point.value);
    if (!good || !is_good(point)) throw wrong(quoted(part) + " is no point");
    if (!points.empty() && point.at < points.back().at) throw wrong("places do not ascend");
    points.push_back(point);
  }
  return points;
}

double value_at(const std::vector<MapPoint>& points, double at) {
  const auto next = std::upper_bound(points.begin(), points.end(), at,
                                     [](double place, const MapPoint& point) { return place < point.at; });
  if (next == points.begin()) return points.front().value;
  if (next == points.end()) return points.back().value;
  const MapPoint& a = *(next - 1);
  const MapPoint& b = *next;
  return a.value + (b.value - a.value) * (at - a.at) / (b.at - a.at);
}

// Its values at steps + 1 places from `first` to `last`.
std::vector<double> evenly_spaced(const std::vector<MapPoint>& points, double first, double last, std::size_t steps) {
  std::vector<double> values;
  for (std::size_t i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(steps);
    values.push_back(value_at(points, i == steps ? last : first + (last - first) * share));
  }
  return values;
}

constexpr std::size_t map_steps = 1024;

}  // namespace

std::vector<double> parse_opacity_map(const std::string& text) {
  const auto is_good = [](const MapPoint& point) {
    return point.at >= 0.0 && point.at <= 1.0 && point.value >= 0.0 && point.value <= 1.0;
  };
  const std::vector<MapPoint> points =
      parse_points("--opacity-map", text, "PLACE:OPACITY,..., such as 0:0,0.3:0.05,1:1, all from 0 to 1", is_good);
  return evenly_spaced(points, 0.0, 1.0, map_steps);
}

RadiusMap parse_radius_map(const std::string& text) {
  const std::string expected = "VALUE:RADIUS,..., such as 0:0.1,2:0.5, with two values or more";
  const auto is_good = [](const MapPoint& point) {
    return std::isfinite(point.at) && point.value >= 0.0 && std::isfinite(point.value);
  };
  const std::vector<MapPoint> points = parse_points("--radius-map", text, expected, is_good);
  RadiusMap map{{points.front().at, points.back().at}, {}};
  if (!(map.range[0] < map.range[1])) throw UsageError("--radius-map " + text + ": expected " + expected);
  map.radii = evenly_spaced(points, map.range[0], map.range[1], points.size() == 2 ? 1 : map_steps);
  return map;
}

std::vector<int> parse_elements(const std::string& text) {
  std::vector<int> elements;
  for (const std::string& part : split_at(text, ',')) {
    elements.push_back(element_of_symbol(part));
    if (elements.back() == 0) {
      throw UsageError("--elements " + text + ": " + quoted(part) + " is no element, expected symbols such as O,H,Na");
    }
  }
  return elements;
}

std::optional<std::array<double, 3>> parse_color(const std::string& text) {
  std::string_view hex = text;
  for (const auto& [name, value] : color_names) {
    if (text == name) hex = value;
  }
  if (hex.size() != 7 || hex[0] != '#') return std::nullopt;
  Vector color = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const int high = hex_digit(hex[1 + 2 * i]);
    const int low = hex_digit(hex[2 + 2 * i]);
    if (high < 0 || low < 0) return std::nullopt;
    color[i] = linear_of_srgb((16 * high + low) / 255.0);
  }
  return color;
}

std::array<double, 4> parse_background(const std::string& text) {
  // Not all zero: that would be the library's default.
  if (text == "transparent") return {1, 1, 1, 0};
  const auto color = parse_color(text);
  if (!color) {
    std::string names;
    for (const auto& [name, value] : color_names) names.append(", ").append(name);
    throw UsageError("--background " + text + ": expected #rrggbb, transparent" + names);
  }
  return {(*color)[0], (*color)[1], (*color)[2], 1.0};
}

}  // namespace replay
