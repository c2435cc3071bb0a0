// Plays frames through insitu.h as a simulation would: one context, one set of particles, a step per frame.
#pragma once

#include "insitu/insitu.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "appearance.h"
#include "frame.h"
#include "options.h"

namespace replay {

// A call of the library failed; the message is the library's.
class LibraryError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Player {
 public:
  explicit Player(const Options& options);

  // The next frame is of other data than the one before: the camera is fitted anew.
  void begin_file() { fit_ = true; }
  // Renders and writes the pictures of one step. With --order permute the library permutes the arrays of the frame.
  // Throws LibraryError, or UsageError when the frame does not have what the options ask for.
  void play(Frame& frame);

 private:
  // The arrays of one step as the library gets them: views of the frame's memory.
  struct Arrays {
    RadiusChoice radius;
    std::vector<std::int32_t> type;
    insitu_array position_array;
    insitu_array radius_array;
    insitu_array type_array;
    std::vector<insitu_array> values;
    std::vector<insitu_attribute> attributes;
  };

  void check(insitu_status status) const;
  void create_view();
  void create_image();
  std::uint64_t number_of(const Frame& frame);
  void update(Frame& frame, Arrays& arrays);
  void set_style(const ColorChoice& color);
  void set_filter(const Frame& frame);
  void update_glyphs(const Frame& frame);
  void fit();
  void draw(std::uint64_t step, double angle_deg);
  void print_line(const std::string& name);

  struct Destroy {
    void operator()(insitu_context context) const { insitu_context_destroy(context); }
  };

  const Options& options_;
  std::unique_ptr<std::remove_pointer_t<insitu_context>, Destroy> context_;
  insitu_geometry particles_ = {};
  insitu_geometry bonds_ = {};    // made with the first step that has some
  insitu_geometry vectors_ = {};  // likewise
  insitu_view view_ = {};
  insitu_image image_ = {};
  std::optional<std::uint64_t> last_step_;
  bool fit_ = true;
  std::chrono::steady_clock::time_point clock_;  // when the last picture was done
};

}  // namespace replay
