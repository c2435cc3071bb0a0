// The arrays of real simulation codes, as small models of them: the same particles in every layout.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "insitu/insitu.h"

namespace insitu::testing {

// Coordinates are multiples of 1/64 from 0 to 64: the same numbers in f32, f64, and on lattices of 32 bits.
struct Particle {
  std::uint32_t q[3];  // world position times 64, below 4096
  double value;        // exact in f32, as is the radius
  double radius;
  std::uint32_t id;
};

std::vector<Particle> some_particles(std::size_t count, std::uint64_t seed);

// Zeroed by nobody: begins as noise, so that a byte that moved or changed is seen.
class Memory {
 public:
  explicit Memory(std::size_t bytes);
  std::byte* data() const { return data_.get(); }
  std::size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(std::byte* pointer) const;
  };
  std::size_t size_;
  std::unique_ptr<std::byte, Free> data_;
};

// One layout with the particles in it. Arrays view the memory; what no array views is not the library's business.
struct Layout {
  std::string name;
  std::vector<Memory> memory;
  insitu_array position;
  insitu_array value;
  insitu_array id;
  std::optional<insitu_array> radius;
  std::optional<insitu_array> record;  // whole records as bytes
  double scale = 0.0;                  // of integer positions
  double origin[3] = {};

  Layout(std::string layout_name, std::size_t count);
  std::byte* allocate(std::size_t bytes);
  std::vector<insitu_array*> arrays();
};

// Every layout once, filled with `particles`.
std::vector<std::unique_ptr<Layout>> all_layouts(const std::vector<Particle>& particles);

// Where insitu.h says that a scalar stands.
std::byte* address_of(const insitu_array& array, std::size_t item, std::uint32_t component);
std::size_t scalar_bytes(std::uint32_t type);
void store(const insitu_array& array, std::size_t item, std::uint32_t component, double value);
std::uint64_t load_integer(const insitu_array& array, std::size_t item);

}  // namespace insitu::testing
