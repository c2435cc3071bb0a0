#include "run.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

#include "md/lattice.h"
#include "md/observables.h"

namespace melt {
namespace {

// The thermostat's time constant, in sigma sqrt(m / epsilon).
constexpr double thermostat_tau = 0.1;
// Hotter than any Lennard-Jones system that a time step could follow: the run has blown up.
constexpr double temperature_limit = 1e4;

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Energies per atom, step by step.
class EnergyFile {
 public:
  explicit EnergyFile(const std::string& path) {
    if (path.empty()) return;
    file_.reset(std::fopen(path.c_str(), "w"));
    if (!file_) throw std::invalid_argument("cannot write " + path + ": " + std::strerror(errno));
    std::fprintf(file_.get(), "step,kinetic,potential,total,temperature\n");
  }
  void add(std::uint64_t step, const Energies& e, double atoms) {
    if (!file_) return;
    std::fprintf(file_.get(), "%llu,%.17g,%.17g,%.17g,%.17g\n", static_cast<unsigned long long>(step),
                 e.kinetic / atoms, e.potential / atoms, e.total() / atoms, e.temperature);
  }
  // Whether all lines are on their way to the disk.
  bool complete() { return !file_ || (std::fflush(file_.get()) == 0 && std::ferror(file_.get()) == 0); }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

// How well the energy is kept once the thermostat is off.
struct Drift {
  double start;  // total energy when it was last changed on purpose
  double end = start;
  double largest = 0.0;  // departure from start
  std::uint64_t steps = 0;

  void add(double total) {
    ++steps;
    end = total;
    largest = std::max(largest, std::abs(total - start));
  }
};

// Pictures of a run, and the time the run spent on them.
class Pictures {
 public:
  explicit Pictures(const PictureDesc& desc) : picture_(desc), permutes_(desc.order == INSITU_ORDER_PERMUTE) {}

  void draw(Simulation& simulation) {
    const Clock::time_point start = Clock::now();
    const bool written = picture_.draw(simulation.steps(), simulation.time(), simulation.particles());
    seconds += seconds_since(start);
    if (permutes_) simulation.records_moved();  // also after an error: the records may have moved before it
    ++tried;
    if (written) {
      ++drawn;
    } else if (tried == drawn + 1) {  // say it once; the run goes on
      std::fprintf(stderr, "melt: no picture at step %llu: %s\n", static_cast<unsigned long long>(simulation.steps()),
                   picture_.error().c_str());
    }
  }
  void print_summary(double total_s, const std::string& folder) const {
    const Picture::Cost& cost = picture_.cost();
    std::printf("pictures: %llu of %llu in %s, %.2f s = %.1f %% of the run (build %.2f, render %.2f, write %.2f s)\n",
                static_cast<unsigned long long>(drawn), static_cast<unsigned long long>(tried), folder.c_str(), seconds,
                100.0 * seconds / total_s, cost.build_s, cost.render_s, cost.write_s);
    std::printf("library:  %.1f M rays, %.1f MB at most, %.1f MB of them copies of simulation data\n",
                1e-6 * static_cast<double>(cost.rays), 1e-6 * static_cast<double>(cost.peak_bytes),
                1e-6 * static_cast<double>(cost.copied_bytes));
  }

  double seconds = 0.0;
  std::uint64_t tried = 0;
  std::uint64_t drawn = 0;

 private:
  Picture picture_;
  bool permutes_;
};

// Runs, and keeps what there is to say about it.
class Run {
 public:
  explicit Run(const Options& options)
      : options_(options),
        simulation_(options.simulation),
        atoms_(static_cast<double>(simulation_.particles().size())),
        cells_(lattice_for(options.simulation.atoms).cells),
        energy_file_(options.energy_file) {
    if (options.images) pictures_ = std::make_unique<Pictures>(options.picture);
  }

  int operator()() {
    print_header();
    start_ = Clock::now();
    Energies now = simulation_.energies();
    drift_ = {now.total()};
    energy_file_.add(0, now, atoms_);
    if (pictures_) pictures_->draw(simulation_);
    print_progress(now);
    while (simulation_.steps() < options_.steps) {
      const bool heated = simulation_.steps() < options_.heated_steps();
      if (heated) {
        simulation_.step_with_thermostat(options_.simulation.temperature, thermostat_tau);
      } else {
        simulation_.step();
      }
      now = simulation_.energies();
      energy_file_.add(simulation_.steps(), now, atoms_);
      if (heated) {
        drift_ = {now.total()};
      } else {
        drift_.add(now.total());
      }
      if (!(now.temperature < temperature_limit)) {
        std::fprintf(stderr, "melt: the run blew up at step %llu (temperature %g): try a smaller --dt than %g\n",
                     static_cast<unsigned long long>(simulation_.steps()), now.temperature, options_.simulation.dt);
        return exit_incomplete;
      }
      const bool last = simulation_.steps() == options_.steps;
      if (simulation_.steps() % options_.every != 0 && !last) continue;
      if (pictures_) pictures_->draw(simulation_);
      print_progress(now);
    }
    return print_summary(now);
  }

 private:
  void print_header() const {
    std::printf("melt: %.0f atoms, box side %.2f, density %g, temperature %g, time step %g\n\n", atoms_,
                simulation_.box().side, options_.simulation.density, options_.simulation.temperature,
                options_.simulation.dt);
    std::printf("%15s  %12s  %11s  %7s  %14s  %10s\n", "step", "energy/atom", "temperature", "lattice", "atoms*steps/s",
                "in library");
  }

  // Rates are of the simulation alone; the time in the library stands beside it as a share of all time.
  void print_progress(const Energies& now) const {
    const double total_s = seconds_since(start_);
    const double library_s = pictures_ ? pictures_->seconds : 0.0;
    char rate[32] = "-";
    if (simulation_.steps() > 0) {
      std::snprintf(rate, sizeof rate, "%.2f M",
                    1e-6 * atoms_ * static_cast<double>(simulation_.steps()) / (total_s - library_s));
    }
    std::printf(
        "%6llu / %6llu  %12.6f  %11.4f  %7.3f  %14s  %8.1f %%\n", static_cast<unsigned long long>(simulation_.steps()),
        static_cast<unsigned long long>(options_.steps), now.total() / atoms_, now.temperature,
        translational_order(simulation_.particles(), simulation_.box(), cells_), rate, 100.0 * library_s / total_s);
    std::fflush(stdout);
  }

  int print_summary(const Energies& now) {
    const double total_s = seconds_since(start_);
    const double library_s = pictures_ ? pictures_->seconds : 0.0;
    const double order = translational_order(simulation_.particles(), simulation_.box(), cells_);
    std::printf(
        "\nstate:    temperature %.3f, pressure %.3f, potential energy %.4f per atom, %s (lattice order %.3f)\n",
        now.temperature, now.pressure, now.potential / atoms_, order < 0.1 ? "molten" : "not molten", order);
    if (drift_.steps > 0) {
      std::printf("energy:   %+.2e per atom over the last %llu steps, never more than %.2e from their start\n",
                  (drift_.end - drift_.start) / atoms_, static_cast<unsigned long long>(drift_.steps),
                  drift_.largest / atoms_);
    }
    std::printf("time:     %.2f s, simulation %.2f s (%.2f M atoms*steps/s, %llu neighbour lists)\n", total_s,
                total_s - library_s, 1e-6 * atoms_ * static_cast<double>(simulation_.steps()) / (total_s - library_s),
                static_cast<unsigned long long>(simulation_.list_builds()));
    if (pictures_) pictures_->print_summary(total_s, options_.picture.folder);
    if (!energy_file_.complete()) {
      std::fprintf(stderr, "melt: %s is not complete: %s\n", options_.energy_file.c_str(), std::strerror(errno));
      return exit_incomplete;
    }
    return pictures_ && pictures_->drawn < pictures_->tried ? exit_incomplete : exit_success;
  }

  const Options& options_;
  Simulation simulation_;
  double atoms_;
  std::uint64_t cells_;
  EnergyFile energy_file_;
  std::unique_ptr<Pictures> pictures_;
  Drift drift_{};
  Clock::time_point start_;
};

}  // namespace

int run(const Options& options) { return Run(options)(); }

}  // namespace melt
