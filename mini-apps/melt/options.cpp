#include "options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <map>
#include <regex>

namespace melt {
namespace {

constexpr const char* description =
    "A Lennard-Jones crystal melts, and libinsitu draws it while it runs.\n"
    "\n"
    "Molecular dynamics in reduced units (sigma, epsilon, atom mass): an fcc crystal with random velocities is kept "
    "at\n"
    "a temperature for the first half of the run and then left alone, its energy conserved. Every few steps the "
    "library\n"
    "is handed the simulation's own records and writes a picture, coloured by speed.";

constexpr const char* footer =
    "Exit codes: 0 all done; 1 the run ended early or some files could not be written; 2 the options make no sense.";

// "800x600"
std::string parse_size(const std::string& text, PictureDesc& picture) {
  static const std::regex pattern("([0-9]{1,5})x([0-9]{1,5})");
  std::smatch match;
  if (!std::regex_match(text, match, pattern)) return "'" + text + "' is not WIDTHxHEIGHT, for example 800x600";
  const unsigned long width = std::stoul(match[1]);
  const unsigned long height = std::stoul(match[2]);
  if (width < 16 || height < 16 || width > 16384 || height > 16384) {
    return "'" + text + "' has a side outside of 16 to 16384 pixels";
  }
  picture.width = static_cast<std::uint32_t>(width);
  picture.height = static_cast<std::uint32_t>(height);
  return {};
}

// Small enough for a first look: a few seconds. What the user gave on the command line is kept.
void make_quick(const CLI::App& app, Options& options) {
  const auto given = [&](const char* name) { return app.count(name) > 0; };
  if (!given("--atoms")) options.simulation.atoms = 4000;
  if (!given("--steps")) options.steps = 300;
  if (!given("--every")) options.every = 100;
  if (!given("--size")) {
    options.picture.width = 400;
    options.picture.height = 300;
  }
}

}  // namespace

std::optional<int> parse_options(int argc, char** argv, Options& options) {
  SimulationDesc& simulation = options.simulation;
  PictureDesc& picture = options.picture;
  picture.folder = "melt-images";
  CLI::App app(description, "melt");
  app.footer(footer);
  app.get_formatter()->column_width(32);

  // What an option takes is said by its type name; the limits of a range show up in the message when it is left.
  const auto silent = [](CLI::Validator validator) { return validator.description(""); };
  const auto number = [&](const char* name, auto& value, auto least, auto most, const char* text) {
    app.add_option(name, value, text)->capture_default_str()->type_name("")->check(silent(CLI::Range(least, most)));
  };
  constexpr std::uint64_t many = std::uint64_t{1} << 40;
  number("--atoms", simulation.atoms, std::uint64_t{4}, std::uint64_t{2'000'000'000},
         "atoms, rounded up to 4 k^3 to fill the crystal");
  number("--steps", options.steps, std::uint64_t{1}, many, "time steps");
  app.add_option("--thermostat", options.thermostat_steps, "of these at constant temperature [half]")
      ->type_name("")
      ->check(silent(CLI::Range(std::uint64_t{0}, many)));
  number("--every", options.every, std::uint64_t{1}, many, "steps from picture to picture");
  number("--density", simulation.density, 0.001, 1.5, "atoms per sigma^3");
  number("--temperature", simulation.temperature, 0.001, 100.0, "temperature, in epsilon / k_B");
  number("--dt", simulation.dt, 1e-6, 0.05, "time step, in sigma sqrt(m / epsilon)");
  number("--seed", simulation.seed, std::uint64_t{0}, std::uint64_t{1} << 62, "of the starting velocities");
  number("--threads", simulation.threads, 0, 4096, "of the simulation and of the library; 0 = all of the machine");
  app.add_option("--energy", options.energy_file, "CSV file with the energies per atom of every step")
      ->type_name("FILE");

  app.add_option("--out", picture.folder, "for the pictures")->capture_default_str()->type_name("FOLDER");
  app.add_option_function<std::string>(
         "--size",
         [&](const std::string& text) {
           if (const std::string problem = parse_size(text, picture); !problem.empty()) {
             throw CLI::ValidationError("--size", problem);
           }
         },
         "pixels of a picture [800x600]")
      ->type_name("WIDTHxHEIGHT");
  number("--ao", picture.ao_samples, 0u, 4096u, "ambient occlusion rays per hit; 0 = none");
  app.add_flag("--shadows", picture.shadows, "shadows of the key light");
  const std::map<std::string, std::uint32_t> orders = {
      {"index", INSITU_ORDER_INDEX}, {"permute", INSITU_ORDER_PERMUTE}, {"copy", INSITU_ORDER_COPY}};
  app.add_option_function<std::string>(
         "--order", [&](const std::string& name) { picture.order = orders.at(name); },
         "for the library: move nothing, sort records in place, copy positions [index]")
      ->type_name("index|permute|copy")
      ->check(silent(CLI::IsMember(orders)));
  bool no_images = false;
  app.add_flag("--no-images", no_images, "run the simulation alone, to compare its cost");
  bool quick = false;
  app.add_flag("--quick", quick, "a small run of a few seconds: 4000 atoms, 300 steps, 400x300 pixels");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_success : exit_usage;
  }
  if (quick) make_quick(app, options);
  options.images = !no_images;
  picture.threads = static_cast<std::uint32_t>(simulation.threads);
  // Maxwell's distribution of speeds peaks at sqrt(2 T), in the middle of the colour map; one atom in twenty is faster
  // than twice that and takes the last colour.
  picture.speed_max = 2.0 * std::sqrt(2.0 * simulation.temperature);
  return std::nullopt;
}

}  // namespace melt
