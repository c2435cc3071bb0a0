// Pictures with thousands of particles per pixel: what a number of samples, fixed or adaptive, leaves of error, and
// what it costs. Errors are those of displayed values (sRGB, 0..1), against a reference with 1024 samples per pixel.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "antialiasing_scenes.h"
#include "core/stopwatch.h"
#include "image/image_writer.h"
#include "measure.h"
#include "scene/srgb.h"

namespace {

using bench::CloudPicture;
using bench::Rendered;
using bench::Sampling;
using insitu::FrameBuffer;

struct Options {
  bool quick = false;
  std::string json;
  std::string images;
  std::vector<std::string> scenes = {"clusters", "dust", "occlusion"};
  std::uint64_t particles = 4000000;
  std::uint32_t edge_px = 128;
  std::uint32_t reference_edge = 32;
  int repetitions = 3;
};

std::vector<double> displayed(const FrameBuffer& frame) {
  std::vector<double> values;
  values.reserve(3 * frame.pixel_count());
  for (std::size_t i = 0; i < frame.color.size(); ++i)
    if (i % 4 != 3) values.push_back(insitu::srgb_of_linear(std::clamp(static_cast<double>(frame.color[i]), 0.0, 1.0)));
  return values;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Below which 99 % of the values are, signs left out.
double p99(std::vector<double> values) {
  for (double& v : values) v = std::abs(v);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Row {
  Sampling sampling;
  double seconds = 0.0;
  double mean_samples = 0.0;
  double rms = 0.0;
  double p99 = 0.0;
  double bias = 0.0;        // mean of the linear values, relative to that of the reference
  double flicker = 0.0;     // rms of the difference of two frames, less that of the reference
  double over_error = 0.0;  // share of the pixels
};

// Seconds that fixed sampling needs for an error. Between two numbers of samples by a power law, which errors follow.
double seconds_of_fixed(const std::vector<Row>& rows, double error, double Row::*kind) {
  std::vector<const Row*> fixed;
  for (const Row& row : rows)
    if (row.sampling.max_samples == 0) fixed.push_back(&row);
  std::size_t i = 0;
  while (i + 2 < fixed.size() && fixed[i + 1]->*kind > error) ++i;
  const double slope =
      std::log(fixed[i + 1]->seconds / fixed[i]->seconds) / std::log(fixed[i + 1]->*kind / (fixed[i]->*kind));
  return fixed[i]->seconds * std::pow(error / (fixed[i]->*kind), slope);
}

// Differences of displayed values, eight times as strong, around middle grey.
FrameBuffer difference_picture(const std::vector<double>& off, std::uint32_t edge_px) {
  FrameBuffer frame;
  frame.allocate(edge_px, edge_px, INSITU_CHANNEL_COLOR);
  for (std::size_t i = 0; i < frame.pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      frame.color[4 * i + c] =
          static_cast<float>(insitu::linear_of_srgb(std::clamp(0.5 + 8.0 * off[3 * i + c], 0.0, 1.0)));
    frame.color[4 * i + 3] = 1.0f;
  }
  return frame;
}

// Panels side by side, in rows of `columns`, each pixel twice as large.
FrameBuffer sheet_of(const std::vector<FrameBuffer>& panels, std::uint32_t columns) {
  const std::uint32_t edge = 2 * panels[0].width;
  FrameBuffer sheet;
  sheet.allocate(columns * edge, static_cast<std::uint32_t>(panels.size()) / columns * edge, INSITU_CHANNEL_COLOR);
  for (std::uint32_t y = 0; y < sheet.height; ++y) {
    for (std::uint32_t x = 0; x < sheet.width; ++x) {
      const FrameBuffer& panel = panels[y / edge * columns + x / edge];
      const std::size_t from = 4 * (std::size_t{y % edge / 2} * panel.width + x % edge / 2);
      std::copy_n(&panel.color[from], 4, &sheet.color[4 * (std::size_t{y} * sheet.width + x)]);
    }
  }
  return sheet;
}

std::vector<Sampling> samplings(bool quick) {
  std::vector<Sampling> all;
  for (const std::uint32_t n : {1u, 4u, 16u, 64u, 256u}) all.push_back({"fixed_" + std::to_string(n), n, 0, 0.0});
  all.push_back({"adaptive", 4, 256, 0.02});
  if (quick) return all;
  all.push_back({"adaptive_0.05", 4, 256, 0.05});
  all.push_back({"adaptive_0.01", 4, 1024, 0.01});
  return all;
}

std::vector<Row> measure_scene(const Options& options, const std::string& scene, insitu::Workers& workers,
                               nlohmann::ordered_json& json) {
  CloudPicture cloud(scene, options.particles, options.edge_px, workers);
  const glm::dvec2 shift_px(0.37, 0.21);
  const FrameBuffer reference = cloud.reference(options.reference_edge);
  const std::vector<double> truth = displayed(reference);
  const std::vector<double> truth_moved = displayed(cloud.reference(options.reference_edge, shift_px));
  const std::vector<double> truth_step = difference(truth_moved, truth);
  std::vector<double> light(reference.color.begin(), reference.color.end());
  std::vector<FrameBuffer> panels;
  std::vector<FrameBuffer> differences;

  std::vector<Row> rows;
  std::vector<Rendered> pictures;
  std::vector<bench::Contender> contenders;
  for (const Sampling& sampling : samplings(options.quick)) {
    rows.push_back({sampling});
    pictures.push_back(cloud.render(sampling));
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    contenders.push_back({rows[i].sampling.name, {}, [&, i] { cloud.render(rows[i].sampling); }});
  const std::vector<double> seconds = bench::take_turns(contenders, options.repetitions);

  std::printf("%s: the reference changes by %.4f when the camera moves by %.2f, %.2f pixels\n", scene.c_str(),
              rms(truth_step), shift_px.x, shift_px.y);
  std::printf("%-16s %9s %9s %9s %9s %9s %9s %9s\n", "", "samples", "seconds", "rms", "p99", "bias", "flicker", "over");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Row& row = rows[i];
    const std::vector<double> values = displayed(pictures[i].frame);
    const std::vector<double> off = difference(values, truth);
    const std::vector<double> step = difference(displayed(cloud.render(row.sampling, shift_px).frame), values);
    const std::vector<double> linear(pictures[i].frame.color.begin(), pictures[i].frame.color.end());
    row.seconds = seconds[i];
    row.mean_samples = pictures[i].mean_samples();
    row.rms = rms(off);
    row.p99 = p99(off);
    row.bias = mean(linear) / mean(light) - 1.0;
    row.flicker = rms(difference(step, truth_step));
    row.over_error =
        static_cast<double>(pictures[i].costs.pixels_over_error) / static_cast<double>(pictures[i].costs.pixels);
    std::printf("%-16s %9.2f %9.4f %9.5f %9.5f %+9.5f %9.5f %8.2f%%\n", row.sampling.name.c_str(), row.mean_samples,
                row.seconds, row.rms, row.p99, row.bias, row.flicker, 100.0 * row.over_error);
    if (row.sampling.name == "fixed_1" || row.sampling.name == "fixed_4" || row.sampling.name == "adaptive") {
      panels.push_back(pictures[i].frame);
      differences.push_back(difference_picture(off, options.edge_px));
    }
    json.push_back({{"scene", scene},
                    {"sampling", row.sampling.name},
                    {"mean_samples", row.mean_samples},
                    {"seconds", row.seconds},
                    {"rms_error", row.rms},
                    {"p99_error", row.p99},
                    {"bias", row.bias},
                    {"flicker", row.flicker},
                    {"share_over_error", row.over_error}});
  }
  std::printf("\n");
  std::fflush(stdout);
  if (!options.images.empty()) {
    panels.push_back(reference);
    differences.push_back(difference_picture(std::vector<double>(truth.size(), 0.0), options.edge_px));
    panels.insert(panels.end(), differences.begin(), differences.end());
    const insitu::WriteResult result =
        insitu::write_image(sheet_of(panels, 4), {}, options.images + "/antialiasing_" + scene + ".png");
    if (result.status != INSITU_OK) std::fprintf(stderr, "%s\n", result.message.c_str());
  }
  return rows;
}

const Row& row_named(const std::vector<Row>& rows, const std::string& name) {
  return *std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return row.sampling.name == name; });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Error, flicker and cost of fixed and adaptive sampling of sub-pixel particles");
  Options options;
  app.add_flag("--quick", options.quick, "1M particles, 48 x 48 pixels, one adaptive setting: within 45 s");
  app.add_option("--json", options.json, "write {context, results} to this file");
  app.add_option("--images", options.images,
                 "write one picture per scene to this folder: 1 and 4 samples, adaptive, "
                 "reference, and below them the differences from it, eight times as strong");
  app.add_option("--particles", options.particles)->capture_default_str();
  app.add_option("--edge", options.edge_px, "pixels, a multiple of 16")->capture_default_str();
  app.add_option("--reference-edge", options.reference_edge, "root of the samples per pixel of the reference")
      ->capture_default_str();
  app.add_option("--scenes", options.scenes, "clusters, dust, occlusion")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (options.quick) {
    options.edge_px = 48;
    options.repetitions = 2;
    options.particles = 1000000;
  }

  bench::Report report(argc, argv);
  report.context()["particles"] = options.particles;
  report.context()["edge_px"] = options.edge_px;
  insitu::Workers workers(2);
  // The worst of all scenes.
  const auto note = [&](const std::string& name, double value, bool largest_is_worst) {
    nlohmann::ordered_json& slot = report.results()[name];
    if (slot.is_null() || (value > slot.get<double>()) == largest_is_worst) slot = value;
  };
  for (const std::string& scene : options.scenes) {
    const std::vector<Row> rows = measure_scene(options, scene, workers, report.context()["rows"]);
    const Row& adaptive = row_named(rows, "adaptive");
    note("adaptive_rms_error", adaptive.rms, true);
    note("adaptive_p99_error", adaptive.p99, true);
    note("adaptive_mean_samples", adaptive.mean_samples, true);
    const double speedup = seconds_of_fixed(rows, adaptive.rms, &Row::rms) / adaptive.seconds;
    note("adaptive_speedup_at_equal_error", speedup, false);
    note("adaptive_speedup_at_equal_error_" + scene, speedup, false);
    note("adaptive_speedup_at_equal_p99", seconds_of_fixed(rows, adaptive.p99, &Row::p99) / adaptive.seconds, false);
    note("shimmer_ratio", adaptive.flicker / row_named(rows, "fixed_4").flicker, true);
  }
  for (const auto& [name, value] : report.results().items())
    std::printf("%-40s %.4f\n", name.c_str(), value.get<double>());
  if (!report.write(options.json)) {
    std::fprintf(stderr, "%s could not be written\n", options.json.c_str());
    return 1;
  }
}
