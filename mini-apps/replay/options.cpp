#include "options.h"

#include "insitu/insitu.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <map>

#include "atom_styles.h"
#include "image_name.h"
#include "numbers.h"
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
  std::string bonds;
  std::string replicate;
  std::string opacity_map;
  std::string radius_map;
  std::vector<double> range;
  std::vector<std::string> filters;
  bool no_hetatm = false;
};

const std::map<std::string, Format> format_names = {
    {"data", Format::lammps_data}, {"dump", Format::lammps_dump}, {"xyz", Format::xyz}, {"pdb", Format::pdb},
    {"cif", Format::cif},          {"gro", Format::gro},          {"dcd", Format::dcd}, {"gadget", Format::gadget},
    {"hdf5", Format::hdf5},        {"tipsy", Format::tipsy}};
const std::map<std::string, std::uint32_t> order_names = {
    {"index", INSITU_ORDER_INDEX}, {"permute", INSITU_ORDER_PERMUTE}, {"copy", INSITU_ORDER_COPY}};

template <class Map>
CLI::Validator one_of(const Map& names) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : names) keys.push_back(key);
  return CLI::IsMember(keys);
}

// CLI11 breaks no lines by itself; it indents what follows a line break.
std::string wrapped(std::string_view text) {
  constexpr std::size_t width = 88;
  std::string out;
  std::size_t line = 0;
  Words words;
  split_words(text, words);
  for (const std::string_view word : words) {
    if (line > 0) {
      const bool fits = line + 1 + word.size() <= width;
      out += fits ? ' ' : '\n';
      line = fits ? line + 1 : 0;
    }
    out += word;
    line += word.size();
  }
  return out;
}

void add_reading(CLI::App& app, Options& options, Texts& texts) {
  const char* const group = "Reading";
  app.add_option("FILE", options.files,
                 wrapped("Files to play, one after the other: LAMMPS data and text dump, XYZ and extended XYZ, PDB, "
                         "mmCIF and CIF of crystals, GRO, DCD, and snapshots of Gadget (binary and HDF5) and TIPSY, "
                         "each also as .gz"))
      ->required();
  app.add_option(
         "--trajectory", options.read.trajectories,
         wrapped("Positions, step by step, for the particles of FILE, such as those of a DCD file; may be given "
                 "more than once"))
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->group(group);
  app.add_option("--format", texts.format, wrapped("What the files are, when neither content nor ending tells"))
      ->type_name("FORMAT")
      ->check(one_of(format_names))
      ->group(group);
  app.add_option("--atom-style", options.read.atom_style,
                 wrapped("Atom style of LAMMPS data files, such as full or \"hybrid sphere charge\""))
      ->type_name("STYLE")
      ->group(group);
  app.add_option("--elements", texts.elements, wrapped("Elements of type 1, 2, ..., such as O,H"))
      ->type_name("SYMBOLS")
      ->group(group);
  app.add_flag("--no-hetatm", texts.no_hetatm, wrapped("PDB and mmCIF: without ligands, ions and water"))->group(group);
  app.add_option("--steps", texts.steps,
                 wrapped("A:B:K plays the steps A, A+K, ... below B, counted from 0 over all files"))
      ->type_name("A:B:K")
      ->group(group);
  app.add_flag("--list", options.list,
               wrapped("Print what is in the files (counts, box, attributes), and draw nothing"))
      ->group(group);
}

void add_looks(CLI::App& app, Options& options, Texts& texts) {
  const char* const group = "Looks";
  app.add_option("--color", options.color,
                 wrapped("Attribute that gives the colour (v.x: a component), or uniform, or a colour such as #4080c0; "
                         "by default the element, else the type"))
      ->type_name("NAME")
      ->group(group);
  app.add_option("--colormap", options.colormap,
                 wrapped("Colours of the values; by default one that fits the attribute"))
      ->type_name("MAP")
      ->check(CLI::IsMember({"viridis", "inferno", "coolwarm", "categorical", "elements"}))
      ->group(group);
  app.add_option("--range", texts.range,
                 wrapped("Values at the two ends of the colour map; by default those of the step"))
      ->expected(2)
      ->type_name("LO HI")
      ->group(group);
  app.add_option("--opacity", options.opacity,
                 wrapped("How opaque the particles are, above 0 to 1; what is behind them shines through"))
      ->type_name("F")
      ->check(CLI::Range(0.0, 1.0))
      ->group(group);
  app.add_option("--opacity-map", texts.opacity_map,
                 wrapped("Opacity by value, as points over the colour map from 0 to 1 with straight lines between "
                         "them, such as 0:0,0.3:0.05,1:1; times --opacity"))
      ->type_name("P:F,...")
      ->group(group);
  app.add_option("--radius", options.radius,
                 wrapped("A length, vdw (by element), auto (by the spacing), or the attribute to take; by default the "
                         "file's radius, else vdw, else by the spacing (docs/replay.md)"))
      ->type_name("R")
      ->group(group);
  app.add_option("--radius-map", texts.radius_map,
                 wrapped("Radii by the value of the attribute that --radius names (v.x: a component), as points with "
                         "straight lines between them, such as 0:0.1,2:0.5"))
      ->type_name("V:R,...")
      ->group(group);
  app.add_option("--radius-scale", options.radius_scale, wrapped("Factor on every radius"))
      ->type_name("F")
      ->check(CLI::PositiveNumber)
      ->group(group);
  app.add_option("--filter", texts.filters,
                 wrapped("Draws only the particles for which it holds: speed:0.5..2, type=1,3, box:X0,Y0,Z0,X1,Y1,Z1, "
                         "plane:A,B,C,D (A x + B y + C z >= D), \"not ...\", \"... or ...\"; given several times, "
                         "all of them"))
      ->type_name("CONDITION")
      ->allow_extra_args(false)
      ->group(group);
  app.add_option("--ao", options.ao_samples, wrapped("Ambient occlusion with N rays per hit; 0 = none"))
      ->check(CLI::Range(0, 4096))
      ->type_name("N")
      ->group(group);
  app.add_option("--ao-radius", options.ao_radius,
                 wrapped("How far occlusion reaches; by default a tenth of the scene"))
      ->type_name("R")
      ->check(CLI::PositiveNumber)
      ->group(group);
  app.add_flag("--shadows", options.shadows, wrapped("Cast shadows"))->group(group);
  app.add_option("--background", texts.background, wrapped("#rrggbb, a colour name, or transparent; white by default"))
      ->type_name("COLOR")
      ->group(group);
}

void add_glyphs(CLI::App& app, Options& options, Texts& texts) {
  const char* const group = "Bonds, arrows and the box";
  app.add_option("--bonds", texts.bonds,
                 wrapped("Sticks between all particles nearer than a length, or auto: by the radii of the elements"))
      ->type_name("R|auto")
      ->group(group);
  app.add_option("--ball-and-stick", options.ball_and_stick,
                 wrapped("Balls by this factor smaller, such as 0.25, with bonds: auto, unless --bonds says otherwise"))
      ->type_name("F")
      ->check(CLI::PositiveNumber)
      ->group(group);
  app.add_option("--stick-radius", options.stick_radius,
                 wrapped("Of bonds; by default a quarter of the largest ball's"))
      ->type_name("R")
      ->check(CLI::PositiveNumber)
      ->group(group);
  app.add_option("--vectors", options.vectors,
                 wrapped("Arrows by an attribute with three components, such as velocity"))
      ->type_name("NAME")
      ->group(group);
  app.add_option("--vector-scale", options.vector_scale,
                 wrapped("Length of an arrow over that of its vector; by default the longest is twice the spacing"))
      ->type_name("S")
      ->check(CLI::PositiveNumber)
      ->group(group);
  app.add_flag("--cell", options.cell, wrapped("Draw the edges of the simulation's box"))->group(group);
  app.add_option("--replicate", texts.replicate, wrapped("Draw the box so often along each of its edges"))
      ->type_name("NX,NY,NZ")
      ->group(group);
  app.add_flag("--wrap", options.wrap, wrapped("Show what is outside of the box at its periodic image inside"))
      ->group(group);
}

void add_camera(CLI::App& app, Options& options, Texts& texts) {
  const char* const group = "Camera";
  app.add_option("--camera", texts.camera,
                 wrapped("fit (default), or eye=X,Y,Z,at=X,Y,Z,up=X,Y,Z,fov=DEGREES,height=H"))
      ->type_name("SPEC")
      ->group(group);
  app.add_option("--view", texts.view,
                 wrapped("Where the fitted camera stands: x, -x, y, -y, z (default), -z, iso, or X,Y,Z"))
      ->type_name("FROM")
      ->group(group);
  app.add_flag("--orthographic", options.camera.orthographic, wrapped("No perspective"))->group(group);
  app.add_option("--turntable", options.camera.turntable, wrapped("N pictures of each step, all around the data"))
      ->check(CLI::Range(1, 36000))
      ->type_name("N")
      ->group(group);
}

void add_output(CLI::App& app, Options& options, Texts& texts) {
  const char* const group = "Output";
  app.add_option("--out", options.out,
                 wrapped("Image files, .png or .exr (with depth, position, normal and item); {step}, {step:6} and "
                         "{angle} are filled in; replay_{step}.png by default"))
      ->type_name("PATTERN")
      ->group(group);
  app.add_option("--size", texts.size, wrapped("Pixels; 1024x768 by default"))->type_name("WxH")->group(group);
  app.add_option("--spp", options.samples, wrapped("Samples per pixel; 4 by default"))
      ->check(CLI::Range(1, 65536))
      ->type_name("N")
      ->group(group);
  CLI::Option* const max_samples =
      app.add_option("--max-samples", options.max_samples,
                     wrapped("Pixels take more samples than --spp, up to N, until they are within --pixel-error"))
          ->check(CLI::Range(2, 65536))
          ->type_name("N")
          ->group(group);
  app.add_option("--pixel-error", options.pixel_error,
                 wrapped("Standard error of displayed values, 0..1; 0.02 by default"))
      ->check(CLI::PositiveNumber)
      ->needs(max_samples)
      ->type_name("E")
      ->group(group);
  app.add_option("--report", options.report, wrapped("Append one JSON line per step to this file"))
      ->type_name("FILE")
      ->group(group);
  app.add_option("--threads", options.threads, wrapped("At most so many threads; 0 = all of the machine"))
      ->check(CLI::Range(0, 65536))
      ->type_name("N")
      ->group(group);
  app.add_option("--treelets", options.treelet_share,
                 wrapped("Memory for treelets, as a part of that of the positions: rays take half to three quarters of "
                         "the time with 0.15"))
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--order", texts.order,
                 wrapped("What may happen to the order of the particles: index, permute or copy"))
      ->type_name("ORDER")
      ->check(one_of(order_names))
      ->group(group);
  app.add_flag("--quiet", options.quiet, wrapped("Print errors only"))->group(group);
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
  if (!options.read.trajectories.empty() && options.files.size() != 1) {
    throw UsageError("--trajectory: expected one FILE, whose particles it moves");
  }
  for (const std::string& text : texts.filters) options.filters.push_back(parse_filter(text));
  alternatives_of(options.filters);  // says when they are too many
  if (!texts.bonds.empty()) options.bonds = parse_bonds(texts.bonds);
  if (!texts.replicate.empty()) options.replicate = parse_replicate(texts.replicate);
  if (!(options.opacity > 0.0)) throw UsageError("--opacity: expected a number above 0, at most 1");
  if (!texts.opacity_map.empty()) options.opacity_map = parse_opacity_map(texts.opacity_map);
  if (!texts.radius_map.empty()) options.radius_map = parse_radius_map(texts.radius_map);
  if (options.radius_map && options.radius.empty()) {
    throw UsageError("--radius-map: expected --radius with the attribute that it is for, such as --radius speed");
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
      "  insitu-replay --trajectory run.dcd --ao 8 protein.pdb\n"
      "  insitu-replay --ball-and-stick 0.25 --cell --replicate 3,3,1 quartz.cif\n"
      "  insitu-replay --color density snapshot_012.0.hdf5\n"
      "  insitu-replay --turntable 36 --out spin_{angle:3}.png protein.cif\n"
      "Exit codes: 0 done, 1 the library failed, 2 a file or the command line is wrong.");
  app.get_formatter()->column_width(28);
  app.set_version_flag("--version", std::string("insitu-replay, libinsitu ") + insitu_version_text());
  Options options;
  Texts texts;
  add_reading(app, options, texts);
  add_looks(app, options, texts);
  add_glyphs(app, options, texts);
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
