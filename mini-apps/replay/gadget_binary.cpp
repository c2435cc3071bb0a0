// Binary snapshots of Gadget-1 and -2 and of the many codes that write the same, format 1 and 2, in either byte order.
#include <algorithm>
#include <set>

#include "gadget_header.h"
#include "input_error.h"
#include "numbers.h"
#include "reader.h"
#include "snapshot.h"

namespace replay {
namespace {

struct Block {
  std::string_view tag;
  TypeSet types;
  std::uint32_t components;
};

// Blocks whose owners are known by their tags. Any other is taken for what its size fits.
constexpr Block known_blocks[] = {
    {"POS", all_types, 3}, {"VEL", all_types, 3},          {"ID", all_types, 1},   {"U", gas_type, 1},
    {"RHO", gas_type, 1},  {"HSML", gas_type, 1},          {"NE", gas_type, 1},    {"NH", gas_type, 1},
    {"SFR", gas_type, 1},  {"AGE", star_type, 1},          {"POT", all_types, 1},  {"ACCE", all_types, 3},
    {"ENDT", gas_type, 1}, {"Z", gas_type | star_type, 1}, {"TSTP", all_types, 1},
};

// Reads one file of a snapshot into the builder.
class Piece {
 public:
  Piece(ByteReader& bytes, std::set<std::string>& passed_over) : bytes_(bytes), passed_over_(passed_over) {
    const auto layout = gadget_layout(bytes.peek(4));
    if (!layout) bytes.fail("is no Gadget snapshot, expected a first record of 256 bytes, or of 8 in format 2");
    layout_ = *layout;
    bytes.set_order(layout_.order);
    read_header();
  }

  const GadgetHeader& header() const { return header_; }
  const GadgetLayout& layout() const { return layout_; }

  void read_blocks(std::size_t first, SnapshotBuilder& builder) {
    first_ = first;
    std::set<std::string> seen;
    for (int number = 1; !bytes_.at_end(); ++number) {
      std::string tag = layout_.tagged ? read_tag() : tag_of(number);
      if (!seen.insert(tag).second) bytes_.fail("a second block " + quoted(tag));
      read_block(tag, builder);
    }
    if (header_.all() == 0) return;
    for (const char* needed : {"POS", "VEL", "ID"}) {
      const bool is_needed = !layout_.tagged || std::string_view(needed) == "POS";
      if (is_needed && seen.count(needed) == 0) bytes_.fail("the file ends here, expected the block " + quoted(needed));
    }
    if (types_with_masses() != 0 && seen.count("MASS") == 0) {
      bytes_.fail("the file ends here, expected the block \"MASS\": the header leaves some masses out");
    }
    add_header_masses(builder);
    for (std::size_t t = 0; t < gadget_types; ++t) {
      if (header_.count[t] > 0) builder.add_type(static_cast<std::int32_t>(t), header_.count[t]);
    }
  }

 private:
  std::uint32_t begin_record() {
    record_begin_ = bytes_.offset();
    return bytes_.number<std::uint32_t>("the size of a record");
  }
  void end_record(std::uint32_t begin_marker) {
    const auto end_marker = bytes_.number<std::uint32_t>("the size of a record behind it");
    if (end_marker != begin_marker) {
      bytes_.fail("the record from byte " + std::to_string(record_begin_) + " on has " + std::to_string(begin_marker) +
                  " bytes by the number before it and " + std::to_string(end_marker) + " by that behind it");
    }
  }

  std::string read_tag() {
    const std::uint32_t size = begin_record();
    if (size != 8) bytes_.fail("a record of " + std::to_string(size) + " bytes, expected one of 8 with a block's name");
    std::vector<char> text;
    bytes_.numbers(4, "the name of a block", text);
    bytes_.number<std::uint32_t>("the size of a block");
    end_record(size);
    return std::string(trimmed(std::string_view(text.data(), text.size())));
  }

  void read_header() {
    if (layout_.tagged) {
      if (const std::string tag = read_tag(); tag != "HEAD")
        bytes_.fail("the first block is " + quoted(tag) + ", expected \"HEAD\"");
    }
    constexpr std::uint32_t header_bytes = 256;
    const std::uint32_t size = begin_record();
    if (size != header_bytes) bytes_.fail("a header of " + std::to_string(size) + " bytes, expected 256");
    const char* const what = "the rest of the header";
    const auto integer = [&] { return bytes_.number<std::uint32_t>(what); };
    const auto real = [&] { return bytes_.number<double>(what); };
    for (auto& count : header_.count) count = integer();
    for (auto& mass : header_.mass) mass = real();
    header_.time = real();
    real();  // redshift
    header_.star_formation = integer() != 0;
    integer();  // feedback
    for (auto& count : header_.total_count) count = integer();
    header_.cooling = integer() != 0;
    header_.files = integer();
    header_.box_size = real();
    bytes_.skip(header_bytes + sizeof size + record_begin_ - bytes_.offset(), what);
    end_record(size);
  }

  // Format 1 has no names: what its blocks are follows from their order (user guide, table 3). Behind those that the
  // header promises there may be others, whichever the code was compiled for.
  std::string tag_of(int number) const {
    std::vector<std::string> order;
    const auto put = [&order](bool is_there, std::initializer_list<const char*> tags) {
      if (is_there) order.insert(order.end(), tags.begin(), tags.end());
    };
    put(true, {"POS", "VEL", "ID"});
    put(types_with_masses() != 0, {"MASS"});
    const bool gas = header_.count[0] > 0;
    put(gas, {"U", "RHO"});
    put(gas && header_.cooling, {"NE", "NH"});
    put(gas, {"HSML"});
    put(gas && header_.star_formation, {"SFR"});
    const auto place = static_cast<std::size_t>(number - 1);
    return place < order.size() ? order[place] : "block_" + std::to_string(number);
  }

  TypeSet types_with_masses() const {
    TypeSet types = 0;
    for (std::size_t t = 0; t < gadget_types; ++t) {
      if (header_.count[t] > 0 && header_.mass[t] == 0.0) types |= TypeSet{1} << t;
    }
    return types;
  }

  void read_block(const std::string& tag, SnapshotBuilder& builder) {
    const std::uint32_t marker = begin_record();
    Block block = {tag, all_types, 1};
    std::optional<std::uint32_t> width;
    bool known = tag == "MASS";
    if (known) block.types = types_with_masses();
    for (const Block& candidate : known_blocks) {
      if (candidate.tag != tag) continue;
      block = candidate;
      known = true;
    }
    if (known) width = width_of(block, marker);
    const bool essential = tag == "POS" || tag == "VEL" || tag == "ID" || tag == "MASS";
    if (essential && !width) {
      const std::uint64_t values = count_in(header_, block.types) * block.components;
      bytes_.fail("the block " + quoted(tag) + " has " + std::to_string(marker) + " bytes, expected " +
                  std::to_string(values * 4) + " or " + std::to_string(values * 8) + " by the counts of the header");
    }
    if (!width) width = fit(block, marker);
    if (!width) {
      if (marker > 0) passed_over_.insert(tag);
      bytes_.skip(marker, "the values of a block");
    } else {
      read_values(tag, block, *width, builder);
    }
    end_record(marker);
  }

  std::optional<std::uint32_t> width_of(const Block& block, std::uint32_t marker) const {
    const std::uint64_t count = count_in(header_, block.types);
    return count > 0 ? scalar_bytes(count * block.components, marker) : std::nullopt;
  }

  // Single precision first: a block may fit several kinds, but few codes write doubles.
  std::optional<std::uint32_t> fit(Block& block, std::uint32_t marker) const {
    constexpr std::array<TypeSet, 8> kinds = {all_types, gas_type, gas_type | star_type, 1u << 1, 1u << 2, 1u << 3,
                                              star_type, 1u << 5};
    for (const std::uint32_t width : {4u, 8u}) {
      for (const std::uint32_t components : {1u, 3u}) {
        for (const TypeSet types : kinds) {
          const std::uint64_t count = count_in(header_, types);
          if (count == 0 || static_cast<std::uint32_t>(count * components * width) != marker) continue;
          block.types = types;
          block.components = components;
          return width;
        }
      }
    }
    return std::nullopt;
  }

  template <class T>
  Scalars values_of(std::uint64_t count) {
    std::vector<T> values;
    bytes_.numbers(count, "the values of a block", values);
    return values;
  }
  Scalars values_of(bool whole, std::uint32_t width, std::uint64_t count) {
    if (whole) return width == 4 ? values_of<std::uint32_t>(count) : values_of<std::uint64_t>(count);
    return width == 4 ? values_of<float>(count) : values_of<double>(count);
  }

  void read_values(const std::string& tag, const Block& block, std::uint32_t width, SnapshotBuilder& builder) {
    // Types without values stand between others: their parts go one by one to the places of their particles.
    std::size_t at = first_;
    for (std::size_t t = 0; t < gadget_types; at += header_.count[t], ++t) {
      if (header_.count[t] == 0 || (block.types >> t & 1u) == 0) continue;
      const Scalars values = values_of(tag == "ID", width, std::uint64_t{header_.count[t]} * block.components);
      if (tag == "POS") {
        builder.add_positions(values);
      } else if (tag == "MASS") {
        masses_[t] = values;
      } else {
        builder.add(attribute_name(tag), block.components, at, values);
      }
    }
  }

  // Masses come in the order of the types, some out of the block and some out of the header.
  void add_header_masses(SnapshotBuilder& builder) {
    std::size_t at = first_;
    for (std::size_t t = 0; t < gadget_types; at += header_.count[t], ++t) {
      if (header_.count[t] == 0) continue;
      if (header_.mass[t] != 0.0) masses_[t] = std::vector<double>(header_.count[t], header_.mass[t]);
      builder.add("mass", 1, at, masses_[t]);
    }
  }

  ByteReader& bytes_;
  std::set<std::string>& passed_over_;
  GadgetLayout layout_;
  GadgetHeader header_;
  std::uint64_t record_begin_ = 0;
  std::size_t first_ = 0;
  std::array<Scalars, gadget_types> masses_;
};

class GadgetReader : public FrameReader {
 public:
  explicit GadgetReader(const std::string& path) : path_(path) {}

  bool next(Frame& frame) override {
    frame = Frame();
    if (done_) return false;
    done_ = true;
    SnapshotBuilder builder(frame);
    const std::uint64_t files = header_of(path_).files;
    std::array<std::uint64_t, gadget_types> sum = {};
    GadgetHeader last;
    for (const std::string& path : paths_of_pieces(path_, files)) {
      ByteReader bytes(path);
      Piece piece(bytes, passed_over_);
      last = piece.header();
      if (std::max(last.files, 1u) != std::max<std::uint64_t>(files, 1)) {
        bytes.fail("is a part of a snapshot of " + std::to_string(last.files) + " files, expected one of " +
                   std::to_string(files));
      }
      piece.read_blocks(frame.count(), builder);
      for (std::size_t t = 0; t < gadget_types; ++t) sum[t] += last.count[t];
    }
    if (files > 1) check_totals(sum, last);
    frame.time = last.time;
    frame.box = cube(last.box_size, last.box_size, last.box_size);
    builder.finish();
    return true;
  }

  std::string remark() const override {
    std::string text = remark_;
    for (const std::string& tag : passed_over_) text += ", without the block " + quoted(tag);
    return text;
  }

 private:
  GadgetHeader header_of(const std::string& path) {
    ByteReader bytes(path);
    const Piece piece(bytes, passed_over_);
    remark_ = std::string("format ") + (piece.layout().tagged ? "2" : "1") +
              (piece.layout().order == std::endian::big ? ", big-endian" : ", little-endian");
    return piece.header();
  }

  void check_totals(const std::array<std::uint64_t, gadget_types>& sum, const GadgetHeader& header) const {
    for (std::size_t t = 0; t < gadget_types; ++t) {
      if (static_cast<std::uint32_t>(sum[t]) == header.total_count[t]) continue;
      throw InputError(path_, 0,
                       "the files of the snapshot have " + std::to_string(sum[t]) + " particles of type " +
                           std::to_string(t) + ", expected " + std::to_string(header.total_count[t]) +
                           " by their headers");
    }
  }

  std::string path_;
  std::set<std::string> passed_over_;
  std::string remark_;
  bool done_ = false;
};

}  // namespace

std::unique_ptr<FrameReader> open_gadget_binary(const std::string& path) {
  return std::make_unique<GadgetReader>(path);
}

}  // namespace replay
