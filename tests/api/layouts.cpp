#include "layouts.h"

#include <cstdlib>
#include <cstring>

#include "api_test_tools.h"

namespace insitu::testing {

std::vector<Particle> some_particles(std::size_t count, std::uint64_t seed) {
  SplitMix64 random(seed);
  std::vector<Particle> particles(count);
  for (std::size_t i = 0; i < count; ++i) {
    Particle& p = particles[i];
    for (std::uint32_t& q : p.q) q = static_cast<std::uint32_t>(random.below(4096));
    p.value = static_cast<double>(random.below(1024)) / 1024.0;
    p.radius = static_cast<double>(4 + random.below(24)) / 16.0;
    p.id = static_cast<std::uint32_t>(7 * i + 3);
  }
  return particles;
}

Memory::Memory(std::size_t bytes) : size_(bytes), data_(nullptr) {
  constexpr std::size_t alignment = 128;
  data_.reset(static_cast<std::byte*>(std::aligned_alloc(alignment, (bytes + alignment) / alignment * alignment)));
  SplitMix64 random(bytes);
  for (std::size_t i = 0; i < bytes; ++i) data_.get()[i] = static_cast<std::byte>(random.next() >> 56);
}

void Memory::Free::operator()(std::byte* pointer) const { std::free(pointer); }

Layout::Layout(std::string layout_name, std::size_t count) : name(std::move(layout_name)) {
  position = value = id = insitu_array_records(INSITU_F64, 1, nullptr, count, 0);
}

std::byte* Layout::allocate(std::size_t bytes) { return memory.emplace_back(bytes).data(); }

std::vector<insitu_array*> Layout::arrays() {
  std::vector<insitu_array*> result = {&position, &value, &id};
  if (radius) result.push_back(&*radius);
  if (record) result.push_back(&*record);
  return result;
}

std::size_t scalar_bytes(std::uint32_t type) {
  if (type == INSITU_U8) return 1;
  return type == INSITU_F32 || type == INSITU_I32 || type == INSITU_U32 ? 4 : 8;
}

std::byte* address_of(const insitu_array& array, std::size_t item, std::uint32_t component) {
  const std::size_t size = scalar_bytes(array.type);
  const bool rows = (array.flags & INSITU_ARRAY_ROWS) != 0;
  const bool columns = array.components > 1 && array.component[1] != nullptr;
  const std::size_t packed = rows ? sizeof(void*) : columns ? size : size * array.components;
  const auto stride =
      static_cast<std::ptrdiff_t>(array.stride_bytes == 0 ? static_cast<std::int64_t>(packed) : array.stride_bytes);
  auto* at = static_cast<std::byte*>(array.component[columns ? component : 0]);
  at += static_cast<std::ptrdiff_t>(item) * stride;
  if (rows) std::memcpy(&at, at, sizeof at);
  return columns ? at : at + component * size;
}

void store(const insitu_array& array, std::size_t item, std::uint32_t component, double value) {
  std::byte* at = address_of(array, item, component);
  const auto put = [at](auto converted) { std::memcpy(at, &converted, sizeof converted); };
  switch (array.type) {
    case INSITU_F32:
      return put(static_cast<float>(value));
    case INSITU_F64:
      return put(value);
    case INSITU_I32:
      return put(static_cast<std::int32_t>(value));
    case INSITU_I64:
      return put(static_cast<std::int64_t>(value));
    case INSITU_U8:
      return put(static_cast<std::uint8_t>(value));
    case INSITU_U32:
      return put(static_cast<std::uint32_t>(value));
    default:
      return put(static_cast<std::uint64_t>(value));
  }
}

std::uint64_t load_integer(const insitu_array& array, std::size_t item) {
  std::uint64_t value = 0;
  std::memcpy(&value, address_of(array, item, 0), scalar_bytes(array.type));
  return value;
}

namespace {

using LayoutPointer = std::unique_ptr<Layout>;

LayoutPointer start(const char* name, std::size_t count) { return std::make_unique<Layout>(name, count); }

// A column of its own, packed.
insitu_array column(Layout& layout, std::uint32_t type, std::size_t count, std::uint32_t components = 1) {
  return insitu_array_records(type, components, layout.allocate(count * components * scalar_bytes(type)), count, 0);
}

// Fields `offset` bytes into records of type `Record`.
template <class Record>
struct Records {
  Records(Layout& layout, std::size_t record_count)
      : first(layout.allocate(record_count * sizeof(Record))), count(record_count) {}
  insitu_array field(std::uint32_t type, std::uint32_t components, std::size_t offset) const {
    return insitu_array_records(type, components, first + offset, count, sizeof(Record));
  }
  std::byte* first;
  std::size_t count;
};

// LAMMPS: atom->x[0] is one block of doubles, local atoms first, then ghosts.
LayoutPointer lammps_block(std::size_t n) {
  LayoutPointer layout = start("LAMMPS x[0]", n);
  layout->position = insitu_array_records(INSITU_F64, 3, layout->allocate((n + 50) * 24), n, 24);
  layout->value = column(*layout, INSITU_F64, n);   // q
  layout->radius = column(*layout, INSITU_F64, n);  // radius
  layout->id = column(*layout, INSITU_I32, n);      // tag
  return layout;
}

// Rows of a double ** as they were allocated: wherever, in any order, with something else between them.
insitu_array scattered_rows(Layout& layout, std::size_t n, std::uint32_t components, std::uint64_t seed) {
  const std::size_t row_bytes = (components + 2) * sizeof(double);
  std::byte* pool = layout.allocate(n * row_bytes);
  std::byte* table = layout.allocate(n * sizeof(void*));
  const std::vector<std::size_t> order = shuffled_order(n, seed);
  for (std::size_t i = 0; i < n; ++i) {
    const std::byte* row = pool + order[i] * row_bytes + sizeof(double);
    std::memcpy(table + i * sizeof(void*), &row, sizeof row);
  }
  insitu_array array = insitu_array_records(INSITU_F64, components, table, n, 0);
  array.flags = INSITU_ARRAY_ROWS;
  return array;
}

LayoutPointer double_star_star(std::size_t n) {
  LayoutPointer layout = start("double ** with rows anywhere", n);
  layout->position = scattered_rows(*layout, n, 3, 1);
  layout->value = scattered_rows(*layout, n, 1, 2);
  layout->id = column(*layout, INSITU_U64, n);
  return layout;
}

// The table of LAMMPS' x, taken as what its type says.
LayoutPointer lammps_rows(std::size_t n) {
  LayoutPointer layout = start("LAMMPS x as rows", n);
  std::byte* block = layout->allocate(n * 24);
  std::byte* table = layout->allocate(n * sizeof(void*));
  for (std::size_t i = 0; i < n; ++i) {
    const std::byte* row = block + 24 * i;
    std::memcpy(table + i * sizeof(void*), &row, sizeof row);
  }
  layout->position = insitu_array_records(INSITU_F64, 3, table, n, sizeof(void*));
  layout->position.flags = INSITU_ARRAY_ROWS;
  layout->value = column(*layout, INSITU_F64, n);
  layout->radius = column(*layout, INSITU_F64, n);
  layout->id = column(*layout, INSITU_I64, n);  // tagint of a BIGBIG build
  return layout;
}

// GROMACS in single precision: gmx::RVec, that is float[3].
LayoutPointer gromacs(std::size_t n) {
  LayoutPointer layout = start("GROMACS rvec", n);
  layout->position = column(*layout, INSITU_F32, n, 3);
  layout->value = column(*layout, INSITU_F32, n);
  layout->id = column(*layout, INSITU_I32, n);
  return layout;
}

// OpenFOAM's Field<Vector<double>>, deal.II's vector<Point<3>>, dolfinx' geometry().x().
LayoutPointer points_f64(std::size_t n) {
  LayoutPointer layout = start("OpenFOAM, deal.II and dolfinx points", n);
  layout->position = column(*layout, INSITU_F64, n, 3);
  layout->value = column(*layout, INSITU_F64, n);
  layout->radius = column(*layout, INSITU_F64, n);
  layout->id = column(*layout, INSITU_I64, n);
  return layout;
}

struct GadgetParticle {
  float GravAccel[3];
  float Vel[3];
  std::uint64_t ti_Current;
  std::uint32_t IntPos[3];
  std::uint16_t ID_low;
  std::uint32_t ID_high;
  float Mass;
  std::uint8_t Type;
  std::uint8_t TimeBin;
};

// GADGET-4: integer positions deep inside of particle_data; the world is BoxSize / 2^32 times the integer.
LayoutPointer gadget(std::size_t n) {
  LayoutPointer layout = start("GADGET-4 IntPos", n);
  const Records<GadgetParticle> records(*layout, n);
  layout->position = records.field(INSITU_U32, 3, offsetof(GadgetParticle, IntPos));
  layout->value = records.field(INSITU_F32, 1, offsetof(GadgetParticle, Mass));
  layout->id = records.field(INSITU_U32, 1, offsetof(GadgetParticle, ID_high));
  layout->scale = 64.0 / 4294967296.0;
  return layout;
}

// PKDGRAV3: bytes, and offsets that are known when the program runs.
LayoutPointer pkdgrav(std::size_t n, std::uint32_t type) {
  LayoutPointer layout = start(type == INSITU_I32 ? "PKDGRAV3 integer positions" : "PKDGRAV3 doubles", n);
  const std::size_t position_offset = 16;
  const std::size_t mass_offset = position_offset + 3 * scalar_bytes(type) + 4;
  const std::size_t id_offset = (mass_offset + 4 + 7) / 8 * 8;
  const auto stride = static_cast<std::int64_t>(id_offset + 24);
  std::byte* first = layout->allocate(n * static_cast<std::size_t>(stride));
  layout->position = insitu_array_records(type, 3, first + position_offset, n, stride);
  layout->value = insitu_array_records(INSITU_F32, 1, first + mass_offset, n, stride);
  layout->id = insitu_array_records(INSITU_U64, 1, first + id_offset, n, stride);
  if (type == INSITU_I32) {
    layout->scale = 64.0 / 4294967296.0;
    for (double& x : layout->origin) x = 32.0;  // the integers are about the middle of the box
  }
  return layout;
}

struct alignas(128) SwiftGpart {
  std::int64_t id_or_neg_offset;
  double x[3];
  float v_full[3];
  float a_grav[3];
  float mass;
  float potential;
  std::int8_t time_bin;
};

LayoutPointer swift_gpart(std::size_t n, bool whole_records) {
  LayoutPointer layout = start(whole_records ? "SWIFT gpart, moved whole" : "SWIFT gpart", n);
  const Records<SwiftGpart> records(*layout, n);
  layout->position = records.field(INSITU_F64, 3, offsetof(SwiftGpart, x));
  layout->value = records.field(INSITU_F32, 1, offsetof(SwiftGpart, mass));
  layout->id = records.field(INSITU_I64, 1, offsetof(SwiftGpart, id_or_neg_offset));
  if (whole_records) layout->record = records.field(INSITU_U8, sizeof(SwiftGpart), 0);
  return layout;
}

struct alignas(128) SwiftPart {
  std::int64_t id;
  SwiftGpart* gpart;
  double x[3];
  float v[3];
  float a_hydro[3];
  float mass;
  float h;
  float u;
  float rho;
  double viscosity[4];
};

LayoutPointer swift_part(std::size_t n) {
  LayoutPointer layout = start("SWIFT part", n);
  const Records<SwiftPart> records(*layout, n);
  layout->position = records.field(INSITU_F64, 3, offsetof(SwiftPart, x));
  layout->radius = records.field(INSITU_F32, 1, offsetof(SwiftPart, h));
  layout->value = records.field(INSITU_F32, 1, offsetof(SwiftPart, u));
  layout->id = records.field(INSITU_I64, 1, offsetof(SwiftPart, id));
  return layout;
}

insitu_array columns(Layout& layout, std::uint32_t type, std::size_t n) {
  const std::size_t bytes = n * scalar_bytes(type);
  std::byte* const x = layout.allocate(bytes);
  std::byte* const y = layout.allocate(bytes);
  return insitu_array_columns(type, x, y, layout.allocate(bytes), n);
}

LayoutPointer hacc(std::size_t n) {
  LayoutPointer layout = start("HACC columns", n);
  layout->position = columns(*layout, INSITU_F32, n);  // xx, yy, zz
  layout->value = column(*layout, INSITU_F32, n);      // phi
  layout->id = column(*layout, INSITU_I64, n);         // pid
  return layout;
}

struct AmrexParticle {
  double pos[3];
  double rdata[4];
  std::uint64_t idcpu;
  std::int32_t idata[2];
};

LayoutPointer amrex_records(std::size_t n) {
  LayoutPointer layout = start("AMReX ParticleBase", n);
  const Records<AmrexParticle> records(*layout, n);
  layout->position = records.field(INSITU_F64, 3, offsetof(AmrexParticle, pos));
  layout->radius = records.field(INSITU_F64, 1, offsetof(AmrexParticle, rdata) + 2 * sizeof(double));
  layout->value = records.field(INSITU_F64, 1, offsetof(AmrexParticle, rdata));
  layout->id = records.field(INSITU_U64, 1, offsetof(AmrexParticle, idcpu));
  return layout;
}

LayoutPointer amrex_columns(std::size_t n) {
  LayoutPointer layout = start("AMReX pure columns", n);
  layout->position = columns(*layout, INSITU_F64, n);
  layout->value = column(*layout, INSITU_F64, n);
  layout->id = column(*layout, INSITU_U64, n);
  return layout;
}

struct ChangaParticle {
  double mass;
  double soft;
  double position[3];
  double velocity[3];
  double treeAcceleration[3];
  float potential;
  std::int32_t rung;
  std::int64_t iOrder;
  void* extraData;
};

LayoutPointer changa(std::size_t n) {
  LayoutPointer layout = start("ChaNGa GravityParticle", n);
  const Records<ChangaParticle> records(*layout, n);
  layout->position = records.field(INSITU_F64, 3, offsetof(ChangaParticle, position));
  layout->radius = records.field(INSITU_F64, 1, offsetof(ChangaParticle, soft));
  layout->value = records.field(INSITU_F64, 1, offsetof(ChangaParticle, mass));
  layout->id = records.field(INSITU_I64, 1, offsetof(ChangaParticle, iOrder));
  return layout;
}

// nekRS: one allocation, fields fieldOffset apart, which is a little more than the number of points.
LayoutPointer nek_rs(std::size_t n) {
  LayoutPointer layout = start("nekRS fields", n);
  const std::size_t offset = (n / 8 + 2) * 8;
  auto* first = reinterpret_cast<double*>(layout->allocate(5 * offset * sizeof(double)));
  layout->position = insitu_array_columns(INSITU_F64, first, first + offset, first + 2 * offset, n);
  layout->value = insitu_array_records(INSITU_F64, 1, first + 3 * offset, n, 0);
  layout->radius = insitu_array_records(INSITU_F64, 1, first + 4 * offset, n, 0);
  layout->id = column(*layout, INSITU_I32, n);
  return layout;
}

// Nek5000: arrays of a Fortran common block, each beginning where the one before ends.
LayoutPointer nek5000(std::size_t n) {
  LayoutPointer layout = start("Nek5000 common block", n);
  auto* first = reinterpret_cast<double*>(layout->allocate(4 * n * sizeof(double)));
  layout->position = insitu_array_columns(INSITU_F64, first, first + n, first + 2 * n, n);
  layout->value = insitu_array_records(INSITU_F64, 1, first + 3 * n, n, 0);
  layout->id = column(*layout, INSITU_I32, n);
  return layout;
}

// Item 0 last: a view that runs backwards.
LayoutPointer backwards(std::size_t n) {
  struct Record {
    float radius;
    float x[3];
    std::uint32_t id;
    float value;
  };
  LayoutPointer layout = start("records backwards", n);
  const Records<Record> records(*layout, n);
  const auto field = [&](std::uint32_t type, std::uint32_t components, std::size_t offset) {
    insitu_array array = records.field(type, components, offset);
    array.stride_bytes = -array.stride_bytes;
    if (n > 0) array.component[0] = records.first + (n - 1) * sizeof(Record) + offset;
    return array;
  };
  layout->position = field(INSITU_F32, 3, offsetof(Record, x));
  layout->radius = field(INSITU_F32, 1, offsetof(Record, radius));
  layout->value = field(INSITU_F32, 1, offsetof(Record, value));
  layout->id = field(INSITU_U32, 1, offsetof(Record, id));
  return layout;
}

LayoutPointer padded_float4(std::size_t n) {
  LayoutPointer layout = start("float4 with the radius in w", n);
  std::byte* first = layout->allocate(16 * n);
  layout->position = insitu_array_records(INSITU_F32, 3, first, n, 16);
  layout->radius = insitu_array_records(INSITU_F32, 1, first + 12, n, 16);
  layout->value = column(*layout, INSITU_F32, n);
  layout->id = column(*layout, INSITU_U32, n);
  return layout;
}

void fill(Layout& layout, const std::vector<Particle>& particles) {
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Particle& p = particles[i];
    for (std::uint32_t c = 0; c < 3; ++c) {
      const double world = p.q[c] / 64.0;
      store(layout.position, i, c, layout.scale == 0.0 ? world : (world - layout.origin[c]) / layout.scale);
    }
    store(layout.value, i, 0, p.value);
    store(layout.id, i, 0, p.id);
    if (layout.radius) store(*layout.radius, i, 0, p.radius);
  }
}

}  // namespace

std::vector<std::unique_ptr<Layout>> all_layouts(const std::vector<Particle>& particles) {
  const std::size_t n = particles.size();
  std::vector<LayoutPointer> layouts;
  layouts.push_back(points_f64(n));  // the one that the others are compared with
  layouts.push_back(lammps_block(n));
  layouts.push_back(lammps_rows(n));
  layouts.push_back(double_star_star(n));
  layouts.push_back(gromacs(n));
  layouts.push_back(gadget(n));
  layouts.push_back(pkdgrav(n, INSITU_I32));
  layouts.push_back(pkdgrav(n, INSITU_F64));
  layouts.push_back(swift_gpart(n, false));
  layouts.push_back(swift_gpart(n, true));
  layouts.push_back(swift_part(n));
  layouts.push_back(hacc(n));
  layouts.push_back(amrex_records(n));
  layouts.push_back(amrex_columns(n));
  layouts.push_back(changa(n));
  layouts.push_back(nek_rs(n));
  layouts.push_back(nek5000(n));
  layouts.push_back(backwards(n));
  layouts.push_back(padded_float4(n));
  for (const LayoutPointer& layout : layouts) fill(*layout, particles);
  return layouts;
}

}  // namespace insitu::testing
