#include "fourier.h"

#include <fftw3.h>

#include <algorithm>
#include <new>
#include <stdexcept>

namespace cosmo {
namespace {

using Complex = std::complex<float>;

fftwf_complex* as_fftw(Complex* data) { return reinterpret_cast<fftwf_complex*>(data); }

struct FreePlan {
  void operator()(fftwf_plan_s* plan) const { fftwf_destroy_plan(plan); }
};
using Plan = std::unique_ptr<fftwf_plan_s, FreePlan>;

struct FreeComplex {
  void operator()(Complex* data) const { fftwf_free(data); }
};
using Buffer = std::unique_ptr<Complex, FreeComplex>;

Buffer line_buffer(std::size_t nodes) {
  auto* const data = reinterpret_cast<Complex*>(fftwf_alloc_complex(nodes * Modes::width));
  if (data == nullptr) throw std::bad_alloc();
  std::fill_n(data, nodes * Modes::width, Complex{});
  return Buffer(data);
}

}  // namespace

void Field::Free::operator()(float* data) const { fftwf_free(data); }

Field::Field(std::size_t nodes) : nodes_(nodes), data_(fftwf_alloc_real(nodes * nodes * row_length())) {
  if (!data_) throw std::bad_alloc();
}

struct Fourier::Plans {
  Plan plane_forward, plane_back;  // y and z
  Plan lines_forward, lines_back;  // x, Modes::width lines side by side
};

Fourier::Fourier(std::size_t nodes) : nodes_(nodes) {
  if (nodes == 0 || nodes % 4 != 0) throw std::invalid_argument("a mesh needs a multiple of 4 nodes per side");
  const auto n = static_cast<int>(nodes);
  constexpr auto width = static_cast<int>(Modes::width);
  // One plane is enough to plan with. FFTW_ESTIMATE chooses by rules; FFTW_MEASURE would by the clock, and the last
  // bits of a run would change from day to day.
  std::unique_ptr<float, decltype(&fftwf_free)> plane(fftwf_alloc_real(nodes * (nodes + 2)), fftwf_free);
  const Buffer buffer = line_buffer(nodes);
  auto* const plane_modes = reinterpret_cast<fftwf_complex*>(plane.get());
  fftwf_complex* const line = as_fftw(buffer.get());
  auto plans = std::make_shared<Plans>();
  plans->plane_forward.reset(fftwf_plan_dft_r2c_2d(n, n, plane.get(), plane_modes, FFTW_ESTIMATE));
  plans->plane_back.reset(fftwf_plan_dft_c2r_2d(n, n, plane_modes, plane.get(), FFTW_ESTIMATE));
  const auto lines = [&](int sign) {
    return fftwf_plan_many_dft(1, &n, width, line, nullptr, width, 1, line, nullptr, width, 1, sign, FFTW_ESTIMATE);
  };
  plans->lines_forward.reset(lines(FFTW_FORWARD));
  plans->lines_back.reset(lines(FFTW_BACKWARD));
  if (!plans->plane_forward || !plans->plane_back || !plans->lines_forward || !plans->lines_back) {
    throw std::runtime_error("FFTW cannot plan a transform of this size");
  }
  plans_ = std::move(plans);
}

void Fourier::lines(Field& field, Workers& workers, const Change& change, bool back) const {
  const std::size_t columns = nodes_ / 2 + 1;
  workers.for_each(nodes_, [&](std::size_t y) {
    const Buffer buffer = line_buffer(nodes_);
    const auto line = [&](std::size_t x) { return reinterpret_cast<Complex*>(field.row(x, y)); };
    for (std::size_t z = 0; z < columns; z += Modes::width) {
      const std::size_t count = std::min(Modes::width, columns - z);
      const Modes modes{y, z, count, buffer.get()};
      for (std::size_t x = 0; x < nodes_; ++x) std::copy_n(line(x) + z, count, &modes.at(x, 0));
      fftwf_execute_dft(plans_->lines_forward.get(), as_fftw(buffer.get()), as_fftw(buffer.get()));
      change(modes);
      if (!back) continue;
      fftwf_execute_dft(plans_->lines_back.get(), as_fftw(buffer.get()), as_fftw(buffer.get()));
      for (std::size_t x = 0; x < nodes_; ++x) std::copy_n(&modes.at(x, 0), count, line(x) + z);
    }
  });
}

void Fourier::analyse(Field& field, Workers& workers, const Change& look) const {
  workers.for_each(nodes_, [&](std::size_t x) {
    float* const plane = field.row(x, 0);
    fftwf_execute_dft_r2c(plans_->plane_forward.get(), plane, reinterpret_cast<fftwf_complex*>(plane));
  });
  lines(field, workers, look, false);
}

void Fourier::filter(Field& field, Workers& workers, const Change& change) const {
  workers.for_each(nodes_, [&](std::size_t x) {
    float* const plane = field.row(x, 0);
    fftwf_execute_dft_r2c(plans_->plane_forward.get(), plane, reinterpret_cast<fftwf_complex*>(plane));
  });
  lines(field, workers, change, true);
  workers.for_each(nodes_, [&](std::size_t x) {
    float* const plane = field.row(x, 0);
    fftwf_execute_dft_c2r(plans_->plane_back.get(), reinterpret_cast<fftwf_complex*>(plane), plane);
  });
}

}  // namespace cosmo
