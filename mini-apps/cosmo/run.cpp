#include "run.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <system_error>

#include "pm/power_spectrum.h"
#include "pm/spectrum.h"
#include "summary.h"

namespace cosmo {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

unsigned long long number(std::uint64_t value) { return value; }

// Runs, and keeps what there is to say about it.
class Run {
 public:
  explicit Run(const Options& options)
      : options_(options),
        summary_(options.summary_file),
        spectrum_(options.spectrum_file),
        start_(Clock::now()),
        simulation_(options.simulation) {
    cost_.setup_s = seconds_since(start_);
    if (options.images) picture_ = std::make_unique<Picture>(options.picture);
  }

  int operator()() {
    print_header();
    show();
    while (!simulation_.done()) {
      simulation_.step();
      if (simulation_.steps() % options_.every == 0 || simulation_.done()) show();
    }
    add_up();
    print_summary();
    write_summary(options_, cost_, summary_);
    write_spectrum();
    bool complete = drawn_ == cost_.pictures;
    for (OutputFile* file : {&summary_, &spectrum_}) {
      if (file->complete()) continue;
      std::fprintf(stderr, "cosmo: %s is not complete: %s\n", file->path().c_str(),
                   std::generic_category().message(errno).c_str());
      complete = false;
    }
    return complete ? exit_success : exit_incomplete;
  }

  const RunCost& cost() const { return cost_; }

 private:
  void show() {
    if (picture_) draw();
    print_progress();
  }

  void draw() {
    const Clock::time_point start = Clock::now();
    if (options_.picture.color_by == ColorBy::density) {
      simulation_.color_by_density();
    } else {
      simulation_.color_by_speed();
    }
    cost_.color_s += seconds_since(start);
    ++cost_.pictures;
    if (picture_->draw(simulation_.steps(), simulation_.a(), simulation_.particles())) {
      ++drawn_;
    } else if (cost_.pictures == drawn_ + 1) {  // say it once; the run goes on
      std::fprintf(stderr, "cosmo: no picture at step %llu: %s\n", number(simulation_.steps()),
                   picture_->error().c_str());
    }
  }

  void add_up() {
    cost_.total_s = seconds_since(start_);
    cost_.steps = simulation_.steps();
    cost_.particle_bytes = simulation_.particle_bytes();
    cost_.mesh_bytes = simulation_.mesh_bytes();
    if (picture_) cost_.library = picture_->cost();
  }

  void print_header() const {
    const SimulationDesc& d = simulation_.desc();
    std::printf(
        "cosmo: %llu^3 particles of %.2e solar masses / h, box side %g Mpc/h, mesh %llu^3, redshift %g to %g\n\n",
        number(d.particles), 1e10 * static_cast<double>(simulation_.particles().mass[0]), d.side, number(d.mesh),
        1.0 / d.a_start - 1.0, 1.0 / d.a_end - 1.0);
    std::printf("%13s  %8s  %8s  %13s  %8s  %10s\n", "step", "a", "redshift", "rms contrast", "ms/step", "in library");
  }

  // Rates are of the simulation alone; the time in the library stands beside it as a share of all time.
  void print_progress() {
    add_up();
    char rate[32] = "-";
    if (cost_.steps > 0) std::snprintf(rate, sizeof rate, "%.0f", 1e3 * cost_.step_s());
    std::printf("%5llu / %5llu  %8.4f  %8.3f  %13.4f  %8s  %8.1f %%\n", number(cost_.steps),
                number(simulation_.desc().steps), simulation_.a(), simulation_.redshift(),
                simulation_.density_contrast(), rate, 100.0 * cost_.share());
    std::fflush(stdout);
  }

  void print_summary() const {
    const std::array<double, 3> p = simulation_.total_momentum();
    std::printf("\nstate:    rest momentum %.1e of the sum of all magnitudes\n",
                std::hypot(p[0], p[1], p[2]) / simulation_.absolute_momentum());
    std::printf("time:     %.2f s: start %.2f s, %llu steps of %.0f ms, pictures %.2f s\n", cost_.total_s,
                cost_.setup_s, number(cost_.steps), 1e3 * cost_.step_s(), cost_.library.calls_s + cost_.color_s);
    if (!picture_) return;
    const Picture::Cost& library = cost_.library;
    double build_s = 0.0;
    for (const double s : library.build_s) build_s += s;
    std::printf("pictures: %llu of %llu in %s, %.2f s = %.1f %% of the run (build %.2f, render %.2f, write %.2f s)\n",
                number(drawn_), number(cost_.pictures), options_.picture.folder.c_str(), library.calls_s,
                100.0 * cost_.share(), build_s, library.render_s, library.write_s);
    std::printf(
        "memory:   simulation %.1f MB, %.1f MB of it particles; library %.1f MB at most, %.2f MB without pixels\n",
        1e-6 * static_cast<double>(cost_.host_bytes()), 1e-6 * static_cast<double>(cost_.particle_bytes),
        1e-6 * static_cast<double>(library.peak_bytes), 1e-6 * static_cast<double>(cost_.extra_bytes()));
  }

  void write_spectrum() {
    if (!spectrum_) return;
    const PowerSpectrum linear(simulation_.desc().cosmology);
    const double growth = simulation_.desc().cosmology.growth(simulation_.a());
    std::fprintf(spectrum_.file(), "k,modes,power,linear_power\n");
    for (const PowerBin& bin : measure_power(simulation_.density(), simulation_.desc().side, simulation_.workers())) {
      std::fprintf(spectrum_.file(), "%.6g,%llu,%.6g,%.6g\n", bin.k, number(bin.modes), bin.power,
                   growth * growth * linear(bin.k));
    }
  }

  const Options& options_;
  OutputFile summary_;
  OutputFile spectrum_;
  Clock::time_point start_;
  Simulation simulation_;
  std::unique_ptr<Picture> picture_;
  RunCost cost_;
  std::uint64_t drawn_ = 0;
};

}  // namespace

int run(const Options& options, RunCost* cost) {
  Run run(options);
  const int code = run();
  if (cost != nullptr) *cost = run.cost();
  return code;
}

}  // namespace cosmo
