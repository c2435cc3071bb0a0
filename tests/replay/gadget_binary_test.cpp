#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "binary_writer.h"
#include "gadget_header.h"
#include "read_files.h"
#include "sample_files.h"

namespace replay::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsNan;

void expect_sample(const Frame& frame, bool wide) {
  ASSERT_EQ(frame.count(), 5u);
  EXPECT_EQ(frame.time, 0.25);
  EXPECT_EQ(frame.step, std::nullopt);
  EXPECT_EQ(frame.box.edge[1][1], 50.0);
  const std::vector<double> velocity = values(frame, "velocity");
  for (std::size_t i = 0; i < 15; ++i) {
    EXPECT_EQ(frame.position[i], static_cast<double>(i));
    EXPECT_EQ(velocity[i], 10.0 * static_cast<double>(i));
  }
  EXPECT_THAT(values(frame, "type"), ElementsAre(0, 0, 1, 4, 4));
  EXPECT_THAT(values(frame, "id"), ElementsAre(1, 2, 3, 4, wide ? 5 + std::ldexp(1.0, 40) : 5));
  EXPECT_THAT(values(frame, "mass"), ElementsAre(1, 2, 0.5, 4, 5));
  EXPECT_THAT(values(frame, "internal_energy"), ElementsAre(100, 200, IsNan(), IsNan(), IsNan()));
  EXPECT_THAT(values(frame, "density"), ElementsAre(1, 8, IsNan(), IsNan(), IsNan()));
  EXPECT_THAT(values(frame, "smoothing_length"), ElementsAre(7, 8, IsNan(), IsNan(), IsNan()));
  EXPECT_EQ(frame.find("id")->scalars.index(), wide ? 5u : 3u);
  EXPECT_EQ(frame.find("density")->scalars.index(), wide ? 0u : 1u);
}

TEST(GadgetBinary, BothFormatsOrdersAndPrecisions) {
  Folder folder;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    for (const bool tagged : {false, true}) {
      for (const bool wide : {false, true}) {
        const std::string text = gadget_sample({order, tagged, wide});
        SCOPED_TRACE(::testing::Message() << tagged << wide);
        const std::string path = folder.write("snap", text);
        EXPECT_EQ(detect_format(path), Format::gadget);
        const std::vector<Frame> frames = read_all(path);
        ASSERT_EQ(frames.size(), 1u);
        expect_sample(frames[0], wide);
        expect_sample(read_all(folder.write_gz("snap.gz", text))[0], wide);
      }
    }
  }
}

TEST(GadgetBinary, SnapshotInPieces) {
  Folder folder;
  for (std::uint32_t i = 0; i < 3; ++i) {
    folder.write("snap." + std::to_string(i), gadget_sample({std::endian::little, false, i == 1, 3, 3, 1 + 5 * i}));
  }
  const Frame frame = read_all(folder.path("snap.0"))[0];
  ASSERT_EQ(frame.count(), 15u);
  EXPECT_THAT(values(frame, "type"), ElementsAre(0, 0, 1, 4, 4, 0, 0, 1, 4, 4, 0, 0, 1, 4, 4));
  EXPECT_THAT(values(frame, "density"), ElementsAre(1, 8, IsNan(), IsNan(), IsNan(), 1, 8, IsNan(), IsNan(), IsNan(), 1,
                                                    8, IsNan(), IsNan(), IsNan()));
  EXPECT_EQ(values(frame, "id")[9], 10 + std::ldexp(1.0, 40));
  EXPECT_EQ(values(frame, "id")[14], 15);
  EXPECT_THAT(error_of(folder.path("snap.1")),
              HasSubstr("snap.1: is a part of a snapshot of 3 files, expected the first one"));
  std::filesystem::remove(folder.path("snap.2"));
  EXPECT_THAT(error_of(folder.path("snap.0")), HasSubstr("snap.2\" is missing"));
  folder.write("snap.2", gadget_sample({std::endian::little, false, false, 2, 3}));
  EXPECT_THAT(error_of(folder.path("snap.0")), HasSubstr("is a part of a snapshot of 2 files, expected one of 3"));
  folder.write("other", gadget_sample({std::endian::little, false, false, 3, 3}));
  EXPECT_THAT(error_of(folder.path("other")), HasSubstr("expected a name such as snap.0"));
}

TEST(GadgetBinary, PiecesThatDoNotAddUp) {
  Folder folder;
  for (const char* name : {"snap.0", "snap.1"})
    folder.write(name, gadget_sample({std::endian::little, true, false, 2, 3}));
  EXPECT_EQ(error_of(folder.path("snap.0")),
            "snap.0: the files of the snapshot have 4 particles of type 0, expected 6 by their headers");
}

TEST(GadgetBinary, OtherBlocksAreTakenForWhatTheirSizeFits) {
  Folder folder;
  BinaryWriter extra;
  const auto add = [&extra](std::string_view tag, const std::vector<float>& values) {
    extra.record(extra.like().put_text(tag).put(std::uint32_t{0})).record(extra.like().put_all(values));
  };
  add("POT ", {1, 2, 3, 4, 5});
  add("BFLD", {1, 2, 3, 4, 5, 6});
  add("ODD ", {1, 2, 3, 4, 5, 6, 7});
  const std::string path = folder.write("snap", gadget_sample({std::endian::little, true}) + extra.text());
  const auto reader = open_reader(path, {});
  Frame frame;
  ASSERT_TRUE(reader->next(frame));
  EXPECT_THAT(values(frame, "potential"), ElementsAre(1, 2, 3, 4, 5));
  ASSERT_NE(frame.find("BFLD"), nullptr);
  EXPECT_EQ(frame.find("BFLD")->components, 3u);
  EXPECT_EQ(values(frame, "BFLD")[5], 6);
  EXPECT_THAT(values(frame, "BFLD")[6], IsNan());
  EXPECT_EQ(frame.find("ODD"), nullptr);
  EXPECT_EQ(reader->remark(), "format 2, little-endian, without the block \"ODD\"");
}

TEST(GadgetBinary, SizesOfBlocksBeyondThirtyTwoBits) {
  EXPECT_EQ(scalar_bytes(15, 60), 4u);
  EXPECT_EQ(scalar_bytes(15, 120), 8u);
  EXPECT_EQ(scalar_bytes(15, 61), std::nullopt);
  const std::uint64_t positions = 3 * ((std::uint64_t{1} << 31) + 5);
  EXPECT_EQ(scalar_bytes(positions, static_cast<std::uint32_t>(positions * 4)), 4u);
  EXPECT_EQ(scalar_bytes(positions, static_cast<std::uint32_t>(positions * 8)), 8u);
  GadgetHeader header;
  header.count = {4000000000u, 4000000000u, 0, 0, 0, 0};
  EXPECT_EQ(header.all(), 8000000000u);
}

TEST(GadgetBinary, DamagedRecords) {
  Folder folder;
  const std::string good = gadget_sample({});
  const auto changed = [&](std::size_t at, std::string_view bytes) {
    std::string text = good;
    text.replace(at, bytes.size(), bytes);
    return error_of(folder.write("snap", text));
  };
  EXPECT_EQ(changed(264 + 4 + 60, "\x3D"),
            "snap: the record from byte 264 on has 60 bytes by the number before it and 61 by that behind it (at byte "
            "332)");
  EXPECT_THAT(changed(264, "\x3D"), HasSubstr("the block \"POS\" has 61 bytes, expected 60 or 120 by the counts"));
  EXPECT_THAT(changed(260, "\x01"), HasSubstr("256 bytes by the number before it and 257 by that behind it"));
  EXPECT_THAT(changed(4, "\xFF\xFF\xFF\xFF"), HasSubstr("the block \"POS\" has 60 bytes, expected 5153960"));
  EXPECT_THAT(error_of(folder.write("snap", good.substr(0, 332))), HasSubstr("expected the block \"VEL\""));
  EXPECT_THAT(error_of(folder.write("snap", good.substr(0, 264))), HasSubstr("expected the block \"POS\""));
  ReadOptions options;
  options.format = Format::gadget;
  EXPECT_THAT(error_of(folder.write("snap", "no snapshot"), options), HasSubstr("snap: is no Gadget snapshot"));
  const std::string tagged = gadget_sample({std::endian::little, true});
  EXPECT_THAT(error_of(folder.write("snap", std::string(tagged).replace(4, 4, "TAIL"))),
              HasSubstr("the first block is \"TAIL\", expected \"HEAD\""));
}

// A header may promise more particles than any memory holds: with a record that fits them, 0 bytes modulo 2^32.
TEST(GadgetBinary, CountsThatOnlyTheHeaderHas) {
  Folder folder;
  BinaryWriter header;
  header.put(std::uint32_t{1} << 31).fill(256 - 4);
  BinaryWriter file;
  file.record(header);
  file.put(0).fill(100);
  EXPECT_THAT(error_of(folder.write("snap", file.text())), HasSubstr("the file ends too early"));
  EXPECT_THAT(error_of(folder.write_gz("snap.gz", file.text())), HasSubstr("the file ends too early"));
}

}  // namespace
}  // namespace replay::test
