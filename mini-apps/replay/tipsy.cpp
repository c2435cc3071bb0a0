// TIPSY snapshots (Quinn and Katz; written by GASOLINE, ChaNGa, PKDGRAV): a header, then records of gas, dark matter
// and stars. "Standard" files are big-endian, "native" ones as the machine was, which today is little-endian.
#include <algorithm>
#include <array>

#include "byte_reader.h"
#include "input_error.h"
#include "reader.h"
#include "snapshot.h"
#include "tipsy.h"

namespace replay {
namespace {

// The kinds of particles under Gadget's numbers, and what a record holds behind mass, position and velocity.
struct Kind {
  std::int32_t type;
  std::vector<const char*> values;
};
const std::array<Kind, 3> kinds = {{{0, {"density", "temperature", "smoothing_length", "metallicity", "potential"}},
                                    {1, {"softening", "potential"}},
                                    {4, {"metallicity", "formation_time", "softening", "potential"}}}};

class TipsyReader : public FrameReader {
 public:
  explicit TipsyReader(const std::string& path) : bytes_(path) {}

  bool next(Frame& frame) override {
    frame = Frame();
    if (done_) return false;
    done_ = true;
    const auto header = tipsy_header(bytes_.peek(tipsy_header_bytes));
    if (!header) bytes_.fail("is no TIPSY snapshot, expected a header of three dimensions whose counts add up");
    find_layout(*header);
    bytes_.set_order(header->order);
    remark_ = header->order == std::endian::big ? "standard, big-endian" : "native, little-endian";
    if (wide_ > 0) remark_ += wide_ == 3 ? ", positions in double" : ", positions and velocities in double";
    bytes_.skip(header_bytes_, "the header");
    frame.time = header->time;
    SnapshotBuilder builder(frame);
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      if (header->count[k] > 0) read_kind(kinds[k], header->count[k], frame.count(), builder);
    }
    builder.finish();
    return true;
  }

  std::string remark() const override { return remark_; }

 private:
  // Some writers leave the padding of the header out, and some positions, or velocities too, are doubles: nothing in
  // the file says so but its size.
  void find_layout(const TipsyHeader& header) {
    const auto bytes_with = [&header](std::uint64_t header_bytes, std::uint64_t wide) {
      std::uint64_t bytes = header_bytes;
      for (std::size_t k = 0; k < kinds.size(); ++k) {
        bytes += header.count[k] * 4 * (7 + wide + kinds[k].values.size());
      }
      return bytes;
    };
    for (const std::uint64_t wide : {0u, 3u, 6u}) {
      for (const std::uint64_t header_bytes : {tipsy_header_bytes, tipsy_header_bytes - 4}) {
        if (bytes_.size() != bytes_with(header_bytes, wide)) continue;
        if (header_bytes < tipsy_header_bytes && header.padding_is_zero) continue;  // no mass of a first particle
        header_bytes_ = header_bytes;
        wide_ = wide;
        return;
      }
    }
    throw InputError(bytes_.path(), 0,
                     "has " + std::to_string(bytes_.size()) + " bytes, expected " +
                         std::to_string(bytes_with(tipsy_header_bytes, 0)) + " by the counts of its header");
  }

  void read_kind(const Kind& kind, std::uint64_t count, std::size_t first, SnapshotBuilder& builder) {
    const auto n = static_cast<std::size_t>(count);  // no more than the size of the file allows
    std::vector<float> mass(n);
    std::vector<double> position(3 * n);
    std::vector<double> velocity(3 * n);
    std::vector<std::vector<float>> values(kind.values.size(), std::vector<float>(n));
    const char* const what = "a particle";
    const auto scalar = [&](bool wide) {
      return wide ? bytes_.number<double>(what) : static_cast<double>(bytes_.number<float>(what));
    };
    for (std::size_t i = 0; i < n; ++i) {
      mass[i] = bytes_.number<float>(what);
      for (std::size_t c = 0; c < 3; ++c) position[3 * i + c] = scalar(wide_ >= 3);
      for (std::size_t c = 0; c < 3; ++c) velocity[3 * i + c] = scalar(wide_ >= 6);
      for (auto& column : values) column[i] = bytes_.number<float>(what);
    }
    builder.add_positions(position);
    builder.add_type(kind.type, n);
    builder.add("mass", 1, first, mass);
    if (wide_ >= 6) {
      builder.add("velocity", 3, first, velocity);
    } else {
      std::vector<float> narrow(3 * n);
      std::transform(velocity.begin(), velocity.end(), narrow.begin(), [](double v) { return static_cast<float>(v); });
      builder.add("velocity", 3, first, narrow);
    }
    for (std::size_t v = 0; v < values.size(); ++v) builder.add(kind.values[v], 1, first, values[v]);
  }

  ByteReader bytes_;
  std::uint64_t header_bytes_ = tipsy_header_bytes;
  std::uint64_t wide_ = 0;  // numbers of a record that are doubles, from the position on
  std::string remark_;
  bool done_ = false;
};

}  // namespace

std::optional<TipsyHeader> tipsy_header(std::string_view first_bytes) {
  if (first_bytes.size() < tipsy_header_bytes - 4) return std::nullopt;
  for (const std::endian order : {std::endian::big, std::endian::little}) {
    const auto number_at = [&](std::size_t at, auto value) {
      std::memcpy(&value, first_bytes.data() + at, sizeof value);
      return order == std::endian::native ? value : byte_swapped(value);
    };
    TipsyHeader header;
    header.order = order;
    header.time = number_at(0, 0.0);
    for (std::size_t k = 0; k < 3; ++k) header.count[k] = number_at(16 + 4 * k, std::uint32_t{0});
    const std::uint64_t all = number_at(8, std::uint32_t{0});
    const std::uint32_t dimensions = number_at(12, std::uint32_t{0});
    header.padding_is_zero = first_bytes.size() >= tipsy_header_bytes && number_at(28, std::uint32_t{0}) == 0;
    const bool adds_up = all > 0 && all == header.count[0] + header.count[1] + header.count[2];
    if (adds_up && dimensions >= 1 && dimensions <= 3) return header;
  }
  return std::nullopt;
}

std::unique_ptr<FrameReader> open_tipsy(const std::string& path) { return std::make_unique<TipsyReader>(path); }

}  // namespace replay
