// The coupling: everything this program knows of libinsitu.
#pragma once

#include <insitu/insitu.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "md/particle.h"

namespace melt {

struct PictureDesc {
  std::string folder = ".";
  std::uint32_t width = 800;
  std::uint32_t height = 600;
  std::uint32_t ao_samples = 8;  // ambient occlusion rays per hit; 0 = no ambient occlusion
  bool shadows = false;
  std::uint32_t order = INSITU_ORDER_INDEX;
  std::uint32_t threads = 0;  // 0 = as many as the machine has
  double speed_max = 4.0;     // speed at the bright end of the colour map
};

// One series of pictures, drawn from the records of the simulation where they lie. No call of this class throws or
// ends the run: a simulation goes on without pictures.
class Picture {
 public:
  explicit Picture(const PictureDesc& desc);

  // Draws the atoms and writes "<folder>/melt_<step>.png". With INSITU_ORDER_PERMUTE the records change places.
  // Returns whether the file was written; if not, error() says why.
  bool draw(std::uint64_t step, double time, std::span<Particle> particles);

  const std::string& error() const { return error_; }

  // Sums over all pictures so far; see insitu_stats.
  struct Cost {
    double build_s = 0.0;
    double render_s = 0.0;
    double write_s = 0.0;
    std::uint64_t rays = 0;
    std::uint64_t copied_bytes = 0;  // in the last picture
    std::uint64_t peak_bytes = 0;    // all memory of the library
  };
  const Cost& cost() const { return cost_; }

 private:
  bool ok(insitu_status status);
  bool create(const PictureDesc& desc);
  void add_cost();

  struct Destroy {
    void operator()(insitu_context context) const { insitu_context_destroy(context); }
  };
  std::unique_ptr<insitu_context_s, Destroy> context_;  // owns the three below
  insitu_geometry atoms_{};
  insitu_view view_{};
  insitu_image image_{};
  std::string pattern_;
  std::uint32_t order_;
  double aspect_;
  bool ready_ = false;
  bool camera_fitted_ = false;
  std::string error_;
  Cost cost_;
};

}  // namespace melt
