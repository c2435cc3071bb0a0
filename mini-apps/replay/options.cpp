#include "options.h"

#include <insitu/insitu.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <map>

#include "atom_styles.h"
#include "image_name.h"
#include "option_values.h"

namespace replay {
namespace {

// Options that are texts here and values in Options.
struct Texts {
  std::string format;
  std::string elements;
  std::string steps;
  std::string camera;
  std::string view;
  std::string size;
  std::string background;
  std::string order = "index";
  std::vector<double> range;
  bool no_hetatm = false;
};

const std::map<std::string, Format> format_names = {{"data", Format::lammps_data},
                                                    {"dump", Format::lammps_dump},
                                                    {"xyz", Format::xyz},
                                                    {"pdb", Format::pdb},
                                                    {"cif", Format::cif}};
const std::map<std::string, std::uint32_t> order_names = {
    {"index", INSITU_ORDER_INDEX}, {"permute", INSITU_ORDER_PERMUTE}, {"copy", INSITU_ORDER_COPY}};

template <class Map>
CLI::Validator one_of(const Map& names) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : names) keys.push_back(key);
  return CLI::IsMember(keys);
}

void add_reading(CLI::App& app, Options& options, Texts& texts) {
  const char* const group = "Reading";
  app.add_option("FILE", options.files,
                 "Files to play, one after the other: LAMMPS data and text dump, XYZ and extended XYZ, PDB, mmCIF and "
                 "CIF of crystals, each also as .gz")
      ->required();
  app.add_option("--format", texts.format, "What the files are, when neither content nor ending tells")
      ->check(one_of(format_names))
      ->group(group);
  app.add_option("--atom-style", options.read.atom_style,
                 "Atom style of LAMMPS data files, such as full or \"hybrid sphere charge\"")
      ->group(group);
  app.add_option("--elements", texts.elements, "Elements of type 1, 2, ..., such as O,H")->group(group);
  app.add_flag("--no-hetatm", texts.no_hetatm, "PDB and mmCIF: without ligands, ions and water")->group(group);
  app.add_option("--steps", texts.steps, "A:B:K plays the steps A, A+K, ... below B, counted from 0 over all files")
      ->group(group);
  app.add_flag("--list", options.list, "Print what is in the files (counts, box, attributes), and draw nothing")
      ->group(group);
}

void add_looks(CLI::App& app, Options& options, Texts& texts) {
  const char* const group = "Looks";
  app.add_option("--color", options.color,
                 "Attribute that gives the colour (v.x: a component), or uniform, or a colour such as #4080c0; by "
                 "default the element, else the type")
      ->group(group);
  app.add_option("--colormap", options.colormap, "Colours of the values; by default one that fits the attribute")
      ->check(CLI::IsMember({"viridis", "inferno", "coolwarm", "categorical", "elements"}))
      ->group(group);
  app.add_option("--range", texts.range, "Values at the two ends of the colour map; by default those of the step")
      ->expected(2)
      ->type_name("LO HI")
      ->group(group);
  app.add_option("--radius", options.radius,
                 "A length, vdw (by element), auto (by the spacing), or the attribute to take; by default the file's "
                 "radius, else vdw, else auto")
      ->group(group);
  app.add_option("--radius-scale", options.radius_scale, "Factor on every radius")
      ->check(CLI::PositiveNumber)
      ->group(group);
  app.add_option("--ao", options.ao_samples, "Ambient occlusion with N rays per hit; 0 = none")
      ->check(CLI::Range(0, 4096))
      ->type_name("N")
      ->group(group);
  app.add_option("--ao-radius", options.ao_radius, "How far occlusion reaches; by default a tenth of the scene")
      ->check(CLI::PositiveNumber)
      ->group(group);
  app.add_flag("--shadows", options.shadows, "Cast shadows")->group(group);
  app.add_option("--background", texts.background, "#rrggbb, a colour name, or transparent; white by default")
      ->group(group);
}

void add_camera(CLI::App& app, Options& options, Texts& texts) {
  const char* const group = "Camera";
  app.add_option("--camera", texts.camera, "fit (default), or eye=X,Y,Z,at=X,Y,Z,up=X,Y,Z,fov=DEGREES,height=H")
      ->group(group);
  app.add_option("--view", texts.view, "Where the fitted camera stands: x, -x, y, -y, z (default), -z, iso, or X,Y,Z")
      ->group(group);
  app.add_flag("--orthographic", options.camera.orthographic, "No perspective")->group(group);
  app.add_option("--turntable", options.camera.turntable, "N pictures of each step, all around the data")
      ->check(CLI::Range(1, 36000))
      ->type_name("N")
      ->group(group);
}

void add_output(CLI::App& app, Options& options, Texts& texts) {
  const char* const group = "Output";
  app.add_option("--out", options.out,
                 "Image files, .png or .exr (with depth, position, normal and item); {step}, {step:6} and {angle} are "
                 "filled in; replay_{step}.png by default")
      ->group(group);
  app.add_option("--size", texts.size, "Pixels; 1024x768 by default")->type_name("WxH")->group(group);
  app.add_option("--spp", options.samples, "Samples per pixel; 4 by default")
      ->check(CLI::Range(1, 65536))
      ->type_name("N")
      ->group(group);
  app.add_option("--report", options.report, "Append one JSON line per step to this file")->group(group);
  app.add_option("--threads", options.threads, "At most so many threads; 0 = all of the machine")
      ->check(CLI::Range(0, 65536))
      ->type_name("N")
      ->group(group);
  app.add_option("--order", texts.order, "What may happen to the order of the particles: index, permute or copy")
      ->check(one_of(order_names))
      ->group(group);
  app.add_flag("--quiet", options.quiet, "Print errors only")->group(group);
}

void convert(const Texts& texts, Options& options) {
  if (!texts.format.empty()) options.read.format = format_names.at(texts.format);
  if (!texts.elements.empty()) options.elements = parse_elements(texts.elements);
  if (!texts.steps.empty()) options.steps = parse_steps(texts.steps);
  if (!texts.camera.empty()) parse_camera(texts.camera, options.camera);
  if (!texts.view.empty()) {
    if (options.camera.eye) throw UsageError("--view and the eye of --camera exclude each other");
    parse_view(texts.view, options.camera);
  }
  if (!texts.size.empty()) std::tie(options.width, options.height) = parse_size(texts.size);
  if (!texts.background.empty()) options.background = parse_background(texts.background);
  if (!texts.range.empty()) {
    options.range = {texts.range[0], texts.range[1]};
    if (!std::isfinite(texts.range[0]) || !std::isfinite(texts.range[1]) || texts.range[0] >= texts.range[1]) {
      throw UsageError("--range: expected two numbers, the smaller one first");
    }
  }
  if (!options.read.atom_style.empty() && atom_style_named(options.read.atom_style).columns.empty()) {
    throw UsageError("--atom-style " + options.read.atom_style + ": expected one of " + atom_style_names());
  }
  options.order = order_names.at(texts.order);
  options.read.hetatm = !texts.no_hetatm;
  check_image_pattern(options.out);
}

}  // namespace

std::optional<Options> parse_options(int argc, char** argv) {
  CLI::App app("Draws simulation data from files, step by step, with ray tracing through libinsitu.", "insitu-replay");
  app.footer(
      "Examples:\n"
      "  insitu-replay --ao 16 --shadows 4hhb.pdb.gz\n"
      "  insitu-replay --color speed --range 0 3 --view iso --out melt_{step:6}.png dump.lammpstrj\n"
      "  insitu-replay --turntable 36 --out spin_{angle:3}.png protein.cif\n"
      "Exit codes: 0 done, 1 the library failed, 2 a file or the command line is wrong.");
  app.get_formatter()->column_width(28);
  app.set_version_flag("--version", std::string("insitu-replay, libinsitu ") + insitu_version_text());
  Options options;
  Texts texts;
  add_reading(app, options, texts);
  add_looks(app, options, texts);
  add_camera(app, options, texts);
  add_output(app, options, texts);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    app.exit(done);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw UsageError(std::string(error.what()) + " (--help lists all options)");
  }
  convert(texts, options);
  return options;
}

}  // namespace replay
