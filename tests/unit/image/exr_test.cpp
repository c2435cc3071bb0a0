// EXR files, read back with OpenImageIO.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "image/image_writer.h"
#include "image_test_tools.h"
#include "read_image.h"

namespace insitu {
namespace {

using testing::all_channels;
using testing::ImageFile;
using testing::noisy_frame;
using testing::read_image;
using testing::some_metadata;
using testing::TemporaryFolder;

uint32_t bits(float value) { return std::bit_cast<uint32_t>(value); }

void expect_same_bits(const ImageFile& file, const std::vector<float>& values,
                      const std::vector<std::string>& channels) {
  const size_t count = channels.size();
  for (size_t i = 0; i < values.size(); ++i) {
    ASSERT_EQ(file.value<uint32_t>(i / count, channels[i % count]), bits(values[i])) << channels[i % count] << ' ' << i;
  }
}

TEST(Exr, EveryChannelBitForBitInAllSizes) {
  const TemporaryFolder folder;
  const std::pair<uint32_t, uint32_t> sizes[] = {{1, 1}, {1, 9}, {9, 1}, {7, 5}, {64, 64}, {3, 200}, {129, 65}};
  for (const auto& [width, height] : sizes) {
    const FrameBuffer frame = noisy_frame(width, height, all_channels, 0.75f);
    const std::string path = folder.file("a.exr");
    const WriteResult result = write_image(frame, some_metadata(), path);
    ASSERT_EQ(result.status, INSITU_OK) << result.message;
    EXPECT_EQ(result.file_bytes, std::filesystem::file_size(path));

    const ImageFile file = read_image(path);
    ASSERT_EQ(file.spec.width, static_cast<int>(width));
    ASSERT_EQ(file.spec.height, static_cast<int>(height));
    ASSERT_EQ(file.spec.nchannels, 12);
    EXPECT_EQ(file.spec.get_string_attribute("compression"), "zip");
    expect_same_bits(file, frame.color, {"R", "G", "B", "A"});
    expect_same_bits(file, frame.depth, {"Z"});
    expect_same_bits(file, frame.position, {"P.X", "P.Y", "P.Z"});
    expect_same_bits(file, frame.normal, {"N.X", "N.Y", "N.Z"});
    EXPECT_FALSE(file.has("id.hi"));
    for (size_t i = 0; i < frame.item.size(); ++i) ASSERT_EQ(file.value<uint32_t>(i, "id"), frame.item[i]);
    for (int c = 0; c < file.spec.nchannels; ++c) {
      const bool is_id = file.spec.channelnames[static_cast<size_t>(c)] == "id";
      EXPECT_EQ(file.spec.channelformat(c), is_id ? OIIO::TypeUInt32 : OIIO::TypeFloat);
    }
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.exr"});
}

TEST(Exr, UnusualFloatsStay) {
  const TemporaryFolder folder;
  FrameBuffer frame;
  frame.allocate(3, 1, all_channels);
  frame.color[0] = -1.5f;
  frame.color[1] = 1e30f;
  frame.color[4] = std::numeric_limits<float>::denorm_min();
  frame.position[2] = std::numeric_limits<float>::quiet_NaN();
  frame.normal[1] = -0.0f;
  ASSERT_EQ(write_image(frame, some_metadata(), folder.file("a.exr")).status, INSITU_OK);
  const ImageFile file = read_image(folder.file("a.exr"));
  expect_same_bits(file, frame.color, {"R", "G", "B", "A"});
  expect_same_bits(file, frame.depth, {"Z"});  // infinitely far
  expect_same_bits(file, frame.position, {"P.X", "P.Y", "P.Z"});
  expect_same_bits(file, frame.normal, {"N.X", "N.Y", "N.Z"});
}

TEST(Exr, OnlyChannelsOfTheImage) {
  const TemporaryFolder folder;
  for (const uint32_t channels :
       std::initializer_list<uint32_t>{0, INSITU_CHANNEL_DEPTH, INSITU_CHANNEL_ITEM | INSITU_CHANNEL_NORMAL}) {
    ASSERT_EQ(write_image(noisy_frame(7, 5, channels), some_metadata(), folder.file("a.exr")).status, INSITU_OK);
    const ImageFile file = read_image(folder.file("a.exr"));
    EXPECT_TRUE(file.has("R") && file.has("G") && file.has("B") && file.has("A"));
    EXPECT_EQ(file.has("Z"), (channels & INSITU_CHANNEL_DEPTH) != 0);
    EXPECT_EQ(file.has("P.X"), false);
    EXPECT_EQ(file.has("N.Z"), (channels & INSITU_CHANNEL_NORMAL) != 0);
    EXPECT_EQ(file.has("id"), (channels & INSITU_CHANNEL_ITEM) != 0);
  }
}

TEST(Exr, ItemsOfAllSizesCanBeToldFromTheBackground) {
  const TemporaryFolder folder;
  FrameBuffer frame;
  frame.allocate(4, 1, INSITU_CHANNEL_ITEM);

  frame.item = {0, 0xfffffffeu, FrameBuffer::no_item, 7};  // 32 bits are enough
  ASSERT_EQ(write_image(frame, some_metadata(), folder.file("a.exr")).status, INSITU_OK);
  const ImageFile low = read_image(folder.file("a.exr"));
  EXPECT_FALSE(low.has("id.hi"));
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(low.value<uint32_t>(i, "id"), static_cast<uint32_t>(frame.item[i]));
  EXPECT_EQ(low.value<uint32_t>(2, "id"), 0xffffffffu);

  const std::array<uint64_t, 3> large{0xffffffffu, 0x100000000u, 0xfffffffffffffffeu};
  for (const uint64_t item : large) {
    frame.item = {0, item, FrameBuffer::no_item, 0x123456789abcdefu};
    if (item == 0xffffffffu) frame.item[3] = 7;  // only its background-like low word asks for the high words
    ASSERT_EQ(write_image(frame, some_metadata(), folder.file("a.exr")).status, INSITU_OK);
    const ImageFile file = read_image(folder.file("a.exr"));
    ASSERT_TRUE(file.has("id.hi"));
    EXPECT_EQ(file.spec.channelformat(file.spec.channelindex("id.hi")), OIIO::TypeUInt32);
    for (size_t i = 0; i < 4; ++i) {
      const uint64_t high = file.value<uint32_t>(i, "id.hi");
      EXPECT_EQ((high << 32) | file.value<uint32_t>(i, "id"), frame.item[i]);
    }
  }
}

TEST(Exr, MetadataKeepTheirTypes) {
  const TemporaryFolder folder;
  ImageMetadata metadata = some_metadata();
  ASSERT_EQ(write_image(noisy_frame(7, 5, 0), metadata, folder.file("a.exr")).status, INSITU_OK);
  const ImageFile file = read_image(folder.file("a.exr"));
  const auto number = [&](const char* name) {
    double value = -1;
    EXPECT_TRUE(file.spec.getattribute(name, OIIO::TypeDesc::DOUBLE, &value)) << name;
    return value;
  };
  const auto vector = [&](const char* name) {
    std::array<double, 3> value{-1, -1, -1};
    EXPECT_TRUE(file.spec.getattribute(name, OIIO::TypeDesc(OIIO::TypeDesc::DOUBLE, OIIO::TypeDesc::VEC3), &value));
    return value;
  };
  EXPECT_EQ(file.spec.get_string_attribute("Software"), "insitu 0.1.0");
  EXPECT_EQ(file.spec.get_int_attribute("insitu:step"), 4200);
  EXPECT_EQ(number("insitu:time"), 0.1);
  EXPECT_EQ(file.spec.get_string_attribute("insitu:camera.kind"), "perspective");
  EXPECT_EQ(vector("insitu:camera.eye"), metadata.camera.eye);
  EXPECT_EQ(vector("insitu:camera.look_at"), metadata.camera.look_at);
  EXPECT_EQ(vector("insitu:camera.up"), metadata.camera.up);
  EXPECT_EQ(number("insitu:camera.fov_y_deg"), 35.5);
  EXPECT_FALSE(file.spec.find_attribute("insitu:camera.height"));
  EXPECT_EQ(file.spec.get_int_attribute("insitu:samples_per_pixel"), 16);
  EXPECT_FALSE(file.spec.find_attribute("insitu:max_samples_per_pixel"));
  EXPECT_EQ(number("insitu:seconds.build"), 0.0625);
  EXPECT_EQ(number("insitu:seconds.render"), 1.75);

  metadata.camera.kind = INSITU_CAMERA_ORTHOGRAPHIC;
  metadata.camera.height = 12.5;
  metadata.max_samples_per_pixel = 256;
  metadata.pixel_error = 0.01;
  metadata.mean_samples_per_pixel = 21.5;
  metadata.step = 2147483648u;  // past what an EXR integer holds: a text
  ASSERT_EQ(write_image(noisy_frame(7, 5, 0), metadata, folder.file("b.exr")).status, INSITU_OK);
  const ImageFile second = read_image(folder.file("b.exr"));
  EXPECT_EQ(second.spec.get_string_attribute("insitu:step"), "2147483648");
  EXPECT_EQ(second.spec.get_string_attribute("insitu:camera.kind"), "orthographic");
  EXPECT_EQ(second.spec.get_float_attribute("insitu:camera.height"), 12.5f);
  EXPECT_FALSE(second.spec.find_attribute("insitu:camera.fov_y_deg"));
  EXPECT_EQ(second.spec.get_int_attribute("insitu:max_samples_per_pixel"), 256);
  double value = 0.0;
  EXPECT_TRUE(second.spec.getattribute("insitu:pixel_error", OIIO::TypeDesc::DOUBLE, &value));
  EXPECT_EQ(value, 0.01);
  EXPECT_TRUE(second.spec.getattribute("insitu:mean_samples_per_pixel", OIIO::TypeDesc::DOUBLE, &value));
  EXPECT_EQ(value, 21.5);
}

TEST(Exr, OneInputOneFile) {
  const TemporaryFolder folder;
  const FrameBuffer frame = noisy_frame(33, 17, all_channels, 0.5f);
  ASSERT_EQ(write_image(frame, some_metadata(), folder.file("a.exr")).status, INSITU_OK);
  ASSERT_EQ(write_image(frame, some_metadata(), folder.file("b.Exr")).status, INSITU_OK);
  EXPECT_EQ(testing::bytes_of(folder.file("a.exr")), testing::bytes_of(folder.file("b.Exr")));
  EXPECT_FALSE(read_image(folder.file("a.exr")).spec.find_attribute("DateTime"));
}

}  // namespace
}  // namespace insitu
