#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <regex>

namespace cosmo {
namespace {

constexpr const char* description =
    "Gravity makes the cosmic web out of small ripples, and libinsitu draws it while it happens.\n"
    "\n"
    "A particle-mesh simulation of cold dark matter in an expanding, periodic box, from a Gaussian random field to\n"
    "today. Every few steps the library is handed the simulation's own arrays and writes a picture of a slice.";

constexpr const char* footer =
    "Exit codes: 0 all done; 1 some files could not be written; 2 the options make no sense.\n"
    "Lengths are comoving, in Mpc/h. docs/cosmo.md tells the rest.";

// "1024x1024"
std::string parse_size(const std::string& text, PictureDesc& picture) {
  static const std::regex pattern("([0-9]{1,5})x([0-9]{1,5})");
  std::smatch match;
  if (!std::regex_match(text, match, pattern)) return "'" + text + "' is not WIDTHxHEIGHT, for example 1024x1024";
  const unsigned long width = std::stoul(match[1]);
  const unsigned long height = std::stoul(match[2]);
  if (width < 16 || height < 16 || width > 16384 || height > 16384) {
    return "'" + text + "' has a side outside of 16 to 16384 pixels";
  }
  picture.width = static_cast<std::uint32_t>(width);
  picture.height = static_cast<std::uint32_t>(height);
  return {};
}

// Small enough for a first look: some seconds. What the user gave on the command line is kept.
void make_quick(const CLI::App& app, Options& options) {
  const auto given = [&](const char* name) { return app.count(name) > 0; };
  if (!given("--particles")) options.simulation.particles = 64;
  if (!given("--side")) options.simulation.side = 50.0;
  if (!given("--steps")) options.simulation.steps = 120;
  if (!given("--every")) options.every = 30;
  if (!given("--image")) options.picture.width = options.picture.height = 512;
}

}  // namespace

std::optional<int> parse_options(int argc, char** argv, Options& options) {
  SimulationDesc& simulation = options.simulation;
  Cosmology& cosmology = simulation.cosmology;
  PictureDesc& picture = options.picture;
  picture.folder = "cosmo-images";
  CLI::App app(description, "cosmo");
  app.footer(footer);
  app.get_formatter()->column_width(32);

  // What an option takes is said by its type name; the limits of a range show up in the message when it is left.
  const auto silent = [](CLI::Validator validator) { return validator.description(""); };
  const auto number = [&](const char* name, auto& value, auto least, auto most, const char* text) {
    app.add_option(name, value, text)->capture_default_str()->type_name("")->check(silent(CLI::Range(least, most)));
  };
  constexpr std::uint64_t many = std::uint64_t{1} << 40;
  number("--particles", simulation.particles, std::uint64_t{4}, std::uint64_t{1024}, "per side: 128 means 128^3");
  app.add_option("--mesh", simulation.mesh, "nodes per side of the mesh of forces [twice --particles]")
      ->type_name("")
      ->check(silent(CLI::Range(std::uint64_t{8}, std::uint64_t{2048})));
  number("--side", simulation.side, 1e-3, 1e5, "of the box");
  number("--steps", simulation.steps, std::uint64_t{1}, many, "time steps, of equal sqrt(a)");
  number("--every", options.every, std::uint64_t{1}, many, "steps from picture to picture");
  number("--a-start", simulation.a_start, 1e-4, 10.0, "scale factor at the start; redshift is 1/a - 1");
  number("--a-end", simulation.a_end, 1e-4, 10.0, "scale factor at the end");
  number("--omega-m", cosmology.omega_m, 1e-3, 10.0, "matter, in critical densities");
  number("--omega-lambda", cosmology.omega_lambda, -10.0, 10.0, "cosmological constant; curvature is the rest to 1");
  number("--omega-b", cosmology.omega_b, 0.0, 10.0, "baryons, a part of the matter");
  number("--hubble", cosmology.h, 0.1, 10.0, "h: today's expansion rate in 100 km/s/Mpc");
  number("--n-s", cosmology.n_s, -4.0, 4.0, "spectral index of the first fluctuations");
  number("--sigma-8", cosmology.sigma_8, 1e-6, 10.0, "their size, extrapolated to today");
  number("--seed", simulation.seed, std::uint64_t{0}, std::uint64_t{1} << 62, "of the random field");
  number("--threads", simulation.threads, 0, 4096, "of the simulation and of the library; 0 = all of the machine");
  app.add_option("--summary", options.summary_file, "JSON file with what the run cost, and what of it the pictures")
      ->type_name("FILE");
  app.add_option("--spectrum", options.spectrum_file, "CSV file with the power spectrum at the end")->type_name("FILE");

  app.add_option("--out", picture.folder, "for the pictures")->capture_default_str()->type_name("FOLDER");
  app.add_option_function<std::string>(
         "--image",
         [&](const std::string& text) {
           if (const std::string problem = parse_size(text, picture); !problem.empty()) {
             throw CLI::ValidationError("--image", problem);
           }
         },
         "pixels of a picture [1024x1024]")
      ->type_name("WIDTHxHEIGHT");
  const std::map<std::string, ColorBy> colors = {{"density", ColorBy::density}, {"speed", ColorBy::speed}};
  app.add_option_function<std::string>(
         "--color", [&](const std::string& name) { picture.color_by = colors.at(name); },
         "logarithm of the density around a particle, or its speed [density]")
      ->type_name("density|speed")
      ->check(silent(CLI::IsMember(colors)));
  number("--opacity", picture.opacity, 0.001, 1.0, "of a particle; what is behind it shines through");
  double slab = -1.0;
  app.add_option("--slab", slab, "thickness of the slice that is drawn; 0 = the whole box [13 lattice spacings]")
      ->type_name("")
      ->check(silent(CLI::Range(0.0, 1e5)));
  number("--ao", picture.ao_samples, 0u, 4096u, "ambient occlusion rays per hit; 0 = none");
  number("--samples", picture.samples_per_pixel, 1u, 1024u, "camera rays per pixel");
  const std::map<std::string, std::uint32_t> orders = {
      {"index", INSITU_ORDER_INDEX}, {"permute", INSITU_ORDER_PERMUTE}, {"copy", INSITU_ORDER_COPY}};
  app.add_option_function<std::string>(
         "--order", [&](const std::string& name) { picture.order = orders.at(name); },
         "for the library: move nothing, sort the arrays in place, copy positions [permute]")
      ->type_name("index|permute|copy")
      ->check(silent(CLI::IsMember(orders)));
  bool no_images = false;
  app.add_flag("--no-images", no_images, "run the simulation alone, to compare its cost");
  bool quick = false;
  app.add_flag("--quick", quick, "a small run of some seconds: 64^3 particles, 120 steps, 512x512 pixels");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_success : exit_usage;
  }
  if (quick) make_quick(app, options);
  options.images = !no_images;
  picture.threads = static_cast<std::uint32_t>(simulation.threads);
  picture.side = simulation.side;
  picture.spacing = simulation.side / static_cast<double>(simulation.particles);
  // Thick enough for the starting lattice to look even, thin enough to look through at the end.
  picture.slab = slab < 0.0 ? std::min(13.0 * picture.spacing, 0.25 * simulation.side) : slab;
  return std::nullopt;
}

}  // namespace cosmo
