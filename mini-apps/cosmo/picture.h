// The coupling: everything this program knows of libinsitu.
#pragma once

#include <insitu/insitu.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pm/particles.h"

namespace cosmo {

enum class ColorBy { density, speed };

struct PictureDesc {
  std::string folder = ".";
  std::uint32_t width = 1024;
  std::uint32_t height = 1024;
  std::uint32_t ao_samples = 1;         // ambient occlusion rays per hit; 0 = no ambient occlusion
  std::uint32_t samples_per_pixel = 2;  // camera rays
  std::uint32_t order = INSITU_ORDER_PERMUTE;
  std::uint32_t threads = 0;  // 0 = as many as the machine has
  ColorBy color_by = ColorBy::density;
  double opacity = 1.0;      // of a particle
  double side = 100.0;       // of the box, Mpc/h
  double spacing = 0.78125;  // of the starting lattice, Mpc/h
  double slab = 10.0;        // thickness of the slice that is drawn, Mpc/h; 0 = the whole box, from a corner
};

// One series of pictures, drawn from the arrays of the simulation where they lie. No call of this class throws or ends
// the run: a simulation goes on without pictures.
class Picture {
 public:
  explicit Picture(const PictureDesc& desc);

  // Draws the particles and writes "<folder>/cosmo_<step>.png". With INSITU_ORDER_PERMUTE they change places, all their
  // arrays together. Returns whether the file was written; if not, error() says why.
  bool draw(std::uint64_t step, double a, Particles& particles);

  const std::string& error() const { return error_; }

  // Of all calls so far.
  struct Cost {
    double calls_s = 0.0;  // wall time in calls of the library, by the clock of this program
    double render_s = 0.0;
    double write_s = 0.0;
    std::vector<double> build_s;  // of each picture
    std::uint64_t rays = 0;
    std::uint64_t copied_bytes = 0;        // in the last picture
    std::uint64_t peak_bytes = 0;          // all memory of the library
    std::uint64_t frame_buffer_bytes = 0;  // of these what it needs for the pixels, however many particles there are
  };
  const Cost& cost() const { return cost_; }

 private:
  bool ok(insitu_status status);
  bool create(const PictureDesc& desc);
  bool draw_step(std::uint64_t step, double a, Particles& particles);
  void add_cost();

  struct Destroy {
    void operator()(insitu_context context) const { insitu_context_destroy(context); }
  };
  std::unique_ptr<insitu_context_s, Destroy> context_;  // owns the four below
  insitu_geometry matter_{};
  insitu_view view_{};
  insitu_image image_{};
  insitu_colormap colormap_{};
  std::string pattern_;
  std::uint32_t order_;
  const char* attribute_;
  double radius_;
  double aspect_;
  bool camera_fitted_;  // a camera for a slab is where it should be
  bool ready_ = false;
  std::string error_;
  Cost cost_;
};

}  // namespace cosmo
