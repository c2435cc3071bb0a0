// Periodic fields on a cubic mesh, and what is done to them in Fourier space.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "workers.h"

namespace cosmo {

// Real numbers at nodes^3 places, x slowest. Rows along z have room for the nodes/2 + 1 complex numbers that their
// transform consists of.
class Field {
 public:
  explicit Field(std::size_t nodes);

  std::size_t nodes() const { return nodes_; }
  std::size_t row_length() const { return nodes_ + 2; }
  float* row(std::size_t x, std::size_t y) { return data_.get() + (x * nodes_ + y) * row_length(); }
  const float* row(std::size_t x, std::size_t y) const { return data_.get() + (x * nodes_ + y) * row_length(); }
  float at(std::size_t x, std::size_t y, std::size_t z) const { return row(x, y)[z]; }
  std::uint64_t bytes() const { return nodes_ * nodes_ * row_length() * sizeof(float); }

 private:
  struct Free {
    void operator()(float* data) const;
  };
  std::size_t nodes_;
  std::unique_ptr<float, Free> data_;
};

// Some modes of a field, all with the same wave number y along y: those with z in [z, z + width) and any x.
struct Modes {
  static constexpr std::size_t width = 8;

  std::size_t y;
  std::size_t z;
  std::size_t count;  // of z, at most `width`; the rest of `values` means nothing
  std::complex<float>* values;

  std::complex<float>& at(std::size_t x, std::size_t column) const { return values[x * width + column]; }
};

// FFTW (Frigo & Johnson, Proc. IEEE 93, 216 (2005)), cut into pieces that threads take one by one. FFTW's own threads
// would choose an algorithm by their number, and with it how sums are rounded.
class Fourier {
 public:
  // `nodes` is a multiple of 4: then all planes of a field are aligned alike.
  explicit Fourier(std::size_t nodes);

  // Transforms the field (kernel exp(-ikx), not normalised), calls `change` for all of its modes, in no particular
  // order and from several threads, and transforms back. Each line of modes along x comes by once: on its way through
  // the cache it is transformed forward, changed, and transformed back.
  using Change = std::function<void(const Modes&)>;
  void filter(Field& field, Workers& workers, const Change& change) const;
  // The same without the way back: `look` sees the modes; the field is garbage afterwards.
  void analyse(Field& field, Workers& workers, const Change& look) const;

  // Wave number of mode `index` of `nodes`, in units of the lowest: 0, 1, ... nodes/2, then -nodes/2 + 1 ... -1.
  static std::ptrdiff_t wave_number(std::size_t index, std::size_t nodes) {
    const auto i = static_cast<std::ptrdiff_t>(index);
    return index <= nodes / 2 ? i : i - static_cast<std::ptrdiff_t>(nodes);
  }

 private:
  struct Plans;
  void lines(Field& field, Workers& workers, const Change& change, bool back) const;

  std::size_t nodes_;
  std::shared_ptr<const Plans> plans_;
};

}  // namespace cosmo
