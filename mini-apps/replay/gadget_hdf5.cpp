// Snapshots of Gadget-2 to -4, AREPO, GIZMO, SWIFT and others in HDF5: a group "PartType<n>" for each kind of
// particles, an array for each quantity. A file without such groups but with "Coordinates" at its top is taken as one
// kind.
#include <algorithm>
#include <array>
#include <set>

#include "hdf5_file.h"
#include "input_error.h"
#include "reader.h"
#include "snapshot.h"

namespace replay {
namespace {

constexpr const char* header = "/Header";
constexpr std::string_view group_prefix = "PartType";

// Numbers of the header that are counts: nothing for what is none.
std::optional<std::uint64_t> count_at(const std::vector<double>& values, std::size_t i) {
  constexpr double largest = 1e15;
  if (i >= values.size() || !(values[i] >= 0.0) || values[i] > largest) return std::nullopt;
  return static_cast<std::uint64_t>(values[i]);
}

class SnapshotReader : public FrameReader {
 public:
  explicit SnapshotReader(const std::string& path) : path_(path) {}

  bool next(Frame& frame) override {
    frame = Frame();
    if (done_) return false;
    done_ = true;
    SnapshotBuilder builder(frame);
    const std::uint64_t files = files_in(Hdf5File(path_));
    for (const std::string& path : paths_of_pieces(path_, files)) {
      const Hdf5File file(path);
      if (const std::uint64_t own = files_in(file); own != files) {
        file.fail("is a part of a snapshot of " + std::to_string(own) + " files, expected one of " +
                  std::to_string(files));
      }
      read_file(file, frame, builder);
    }
    if (files > 1) check_totals(Hdf5File(path_));
    builder.finish();
    return true;
  }

  std::string remark() const override {
    std::string text;
    for (const std::string& name : passed_over_) text += (text.empty() ? "without " : ", ") + name;
    return text;
  }

 private:
  static std::uint64_t files_in(const Hdf5File& file) {
    return std::max<std::uint64_t>(1, count_at(file.attribute(header, "NumFilesPerSnapshot"), 0).value_or(1));
  }

  void read_file(const Hdf5File& file, Frame& frame, SnapshotBuilder& builder) {
    bool any = false;
    for (const std::string& group : file.groups_in("/")) {
      if (group.size() != group_prefix.size() + 1 || group.compare(0, group_prefix.size(), group_prefix) != 0) continue;
      const int type = group.back() - '0';
      if (type < 0 || type > 9) continue;
      any = true;
      read_kind(file, "/" + group, type, frame, builder);
    }
    if (!any && file.has("/Coordinates")) {
      any = true;
      read_kind(file, "", -1, frame, builder);
    }
    // A piece of a snapshot may have no particles; a whole file with neither has something else in it.
    if (!any && !file.has(header)) {
      file.fail("has no group \"PartType0\" to \"PartType9\" and no array \"Coordinates\"");
    }
    const std::vector<double> time = file.attribute(header, "Time");
    if (!time.empty()) frame.time = time[0];
    const std::vector<double> box = file.attribute(header, "BoxSize");
    if (box.size() == 1) frame.box = cube(box[0], box[0], box[0]);
    if (box.size() == 3) frame.box = cube(box[0], box[1], box[2]);
  }

  // Type -1: the file has one kind only, without a number.
  void read_kind(const Hdf5File& file, const std::string& group, int type, Frame& frame, SnapshotBuilder& builder) {
    const auto expected =
        type < 0 ? std::nullopt : count_at(file.attribute(header, "NumPart_ThisFile"), static_cast<std::size_t>(type));
    const std::string coordinates = group + "/Coordinates";
    if (!file.has(coordinates)) {
      if (expected.value_or(0) > 0) {
        file.fail("has no array \"" + coordinates + "\", but " + std::to_string(*expected) +
                  " such particles by its header");
      }
      return;
    }
    const Hdf5File::Array shape = file.describe(coordinates);
    if (!shape.numbers || shape.extent.size() != 2 || shape.extent[1] != 3) {
      file.fail("the array \"" + coordinates + "\" is no table of numbers with three columns");
    }
    const std::uint64_t rows = shape.extent[0];
    if (expected && *expected != rows) {
      file.fail("the array \"" + coordinates + "\" has " + std::to_string(rows) + " rows, expected " +
                std::to_string(*expected) + " by the header");
    }
    const std::size_t first = frame.count();
    const auto count = static_cast<std::size_t>(rows);
    if (type >= 0) sum_[static_cast<std::size_t>(type)] += rows;
    if (count == 0) return;
    builder.add_positions(file.read(coordinates));
    if (type >= 0) builder.add_type(type, count);
    for (const std::string& name : file.arrays_in(group.empty() ? "/" : group)) {
      if (name != "Coordinates") read_array(file, group, name, rows, first, builder);
    }
    add_header_mass(file, type, first, count, frame, builder);
  }

  void read_array(const Hdf5File& file, const std::string& group, const std::string& name, std::uint64_t rows,
                  std::size_t first, SnapshotBuilder& builder) {
    constexpr std::uint64_t most_columns = 64;
    std::string path = group;
    path.append("/").append(name);
    const Hdf5File::Array shape = file.describe(path);
    const std::uint64_t columns = shape.extent.size() == 2 ? shape.extent[1] : 1;
    const bool table = shape.extent.size() == 1 || shape.extent.size() == 2;
    if (!shape.numbers || !table || columns == 0 || columns > most_columns) {
      passed_over_.insert(name);
      return;
    }
    if (shape.extent[0] != rows) {
      file.fail("the array \"" + path + "\" has " + std::to_string(shape.extent[0]) + " rows, expected " +
                std::to_string(rows) + " as the coordinates have");
    }
    const Scalars values = file.read(path);
    constexpr std::uint64_t most_components = 4;
    if (columns <= most_components) {
      builder.add(attribute_name(name), static_cast<std::uint32_t>(columns), first, values);
      return;
    }
    // Too many for a vector, such as the abundances of chemical elements: one attribute each.
    for (std::size_t c = 0; c < columns; ++c) {
      builder.add(attribute_name(name) + "_" + std::to_string(c + 1), 1, first, column_of(values, c, columns));
    }
  }

  static Scalars column_of(const Scalars& table, std::size_t column, std::uint64_t columns) {
    return std::visit(
        [&](const auto& values) -> Scalars {
          std::decay_t<decltype(values)> out;
          out.reserve(values.size() / columns);
          for (std::size_t i = column; i < values.size(); i += columns) out.push_back(values[i]);
          return out;
        },
        table);
  }

  static void add_header_mass(const Hdf5File& file, int type, std::size_t first, std::size_t count, const Frame& frame,
                              SnapshotBuilder& builder) {
    const std::vector<double> masses = file.attribute(header, "MassTable");
    if (type < 0 || static_cast<std::size_t>(type) >= masses.size()) return;
    const Attribute* const mass = frame.find("mass");
    const bool has_own = mass && mass->size() > first;
    const double of_all = masses[static_cast<std::size_t>(type)];
    if (!has_own && of_all != 0.0) builder.add("mass", 1, first, std::vector<double>(count, of_all));
  }

  // Old headers have the counts of all files as two words of 32 bits.
  void check_totals(const Hdf5File& file) const {
    const std::vector<double> low = file.attribute(header, "NumPart_Total");
    const std::vector<double> high = file.attribute(header, "NumPart_Total_HighWord");
    for (std::size_t t = 0; t < sum_.size(); ++t) {
      const auto total = count_at(low, t);
      if (!total) continue;
      const std::uint64_t expected = *total + (count_at(high, t).value_or(0) << 32);
      if (sum_[t] == expected) continue;
      file.fail("the files of the snapshot have " + std::to_string(sum_[t]) + " particles of type " +
                std::to_string(t) + ", expected " + std::to_string(expected) + " by the header");
    }
  }

  std::string path_;
  std::set<std::string> passed_over_;
  std::array<std::uint64_t, 10> sum_ = {};
  bool done_ = false;
};

}  // namespace

std::unique_ptr<FrameReader> open_gadget_hdf5(const std::string& path) {
  return std::make_unique<SnapshotReader>(path);
}

}  // namespace replay
