// PNG files, read back with OpenImageIO.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "image/image_writer.h"
#include "image/png_text.h"
#include "image_test_tools.h"
#include "read_image.h"

namespace insitu {
namespace {

using testing::ImageFile;
using testing::noisy_frame;
using testing::read_image;
using testing::some_metadata;
using testing::TemporaryFolder;

// Independent of the library's table.
int srgb_byte(double linear) {
  const double x = std::min(std::max(linear, 0.0), 1.0);
  return static_cast<int>(std::lround(255.0 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055)));
}

TEST(Png, OpaqueImagesOfAllSizes) {
  const TemporaryFolder folder;
  const std::pair<uint32_t, uint32_t> sizes[] = {{1, 1}, {1, 9}, {9, 1}, {7, 5}, {64, 64}, {3, 200}, {129, 65}};
  for (const auto& [width, height] : sizes) {
    const FrameBuffer frame = noisy_frame(width, height, INSITU_CHANNEL_COLOR);
    const std::string path = folder.file("a.png");
    const WriteResult result = write_image(frame, some_metadata(), path);
    ASSERT_EQ(result.status, INSITU_OK) << result.message;
    EXPECT_EQ(result.message, "");
    EXPECT_EQ(result.file_bytes, std::filesystem::file_size(path));

    const ImageFile file = read_image(path);
    ASSERT_EQ(file.spec.width, static_cast<int>(width));
    ASSERT_EQ(file.spec.height, static_cast<int>(height));
    ASSERT_EQ(file.spec.nchannels, 3);
    ASSERT_EQ(file.spec.format, OIIO::TypeUInt8);
    EXPECT_EQ(file.spec.get_string_attribute("oiio:ColorSpace"), "sRGB");
    for (size_t i = 0; i < frame.pixel_count(); ++i) {
      for (size_t c = 0; c < 3; ++c) {
        ASSERT_EQ(file.bytes[3 * i + c], srgb_byte(frame.color[4 * i + c])) << width << 'x' << height << ' ' << i;
      }
    }
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.png"});
}

TEST(Png, AlphaIsKeptAndColorsAreNotPremultiplied) {
  const TemporaryFolder folder;
  FrameBuffer frame;
  frame.allocate(5, 1, INSITU_CHANNEL_COLOR);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  frame.color = {0.5f,  0.25f,  0.125f, 1.0f,    // opaque
                 0.25f, 0.125f, 0.0f,   0.5f,    // half of (0.5, 0.25, 0)
                 0.0f,  0.0f,   0.0f,   0.0f,    // background
                 9.0f,  -1.0f,  nan,    1.0f,    // out of range
                 0.01f, 0.02f,  0.04f,  0.05f};  // nearly transparent
  ASSERT_EQ(write_image(frame, some_metadata(), folder.file("a.png")).status, INSITU_OK);
  const ImageFile file = read_image(folder.file("a.png"));
  ASSERT_EQ(file.spec.nchannels, 4);

  // OpenImageIO multiplies by alpha when it reads, unless it is told not to.
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  const auto input = OIIO::ImageInput::open(folder.file("a.png"), &config);
  std::vector<unsigned char> bytes(20);
  ASSERT_TRUE(input->read_image(0, 0, 0, 4, OIIO::TypeUInt8, bytes.data()));
  const auto byte = [](double linear) { return static_cast<unsigned char>(srgb_byte(linear)); };
  const std::vector<unsigned char> expected{byte(0.5), byte(0.25), byte(0.125), 255,  //
                                            byte(0.5), byte(0.25), 0,           128,  //
                                            0,         0,          0,           0,    //
                                            255,       0,          0,           255,  //
                                            byte(0.2), byte(0.4),  byte(0.8),   13};
  EXPECT_EQ(bytes, expected);
}

TEST(Png, AlphaThatRoundsToOpaqueIsOpaque) {
  const TemporaryFolder folder;
  FrameBuffer frame = noisy_frame(4, 4, INSITU_CHANNEL_COLOR);
  frame.color[7] = 0.9999999f;  // a sum of sample weights
  ASSERT_EQ(write_image(frame, some_metadata(), folder.file("a.png")).status, INSITU_OK);
  EXPECT_EQ(read_image(folder.file("a.png")).spec.nchannels, 3);
  frame.color[7] = 0.99f;
  ASSERT_EQ(write_image(frame, some_metadata(), folder.file("a.png")).status, INSITU_OK);
  EXPECT_EQ(read_image(folder.file("a.png")).spec.nchannels, 4);
}

TEST(Png, MetadataArriveAsTexts) {
  const TemporaryFolder folder;
  ImageMetadata metadata = some_metadata();
  metadata.step = 18446744073709551615u;
  ASSERT_EQ(write_image(noisy_frame(7, 5, 0), metadata, folder.file("a.png")).status, INSITU_OK);
  const ImageFile file = read_image(folder.file("a.png"));
  const auto text = [&](const char* name) { return file.spec.get_string_attribute(name).str(); };
  EXPECT_EQ(text("Software"), "insitu 0.1.0");
  EXPECT_EQ(text("insitu:step"), "18446744073709551615");
  EXPECT_EQ(text("insitu:time"), "0.1");
  EXPECT_EQ(text("insitu:camera.kind"), "perspective");
  EXPECT_EQ(text("insitu:camera.eye"), "1.5 -2.25 1e-30");
  EXPECT_EQ(text("insitu:camera.look_at"), "0.1 0.2 0.3");
  EXPECT_EQ(text("insitu:camera.up"), "0 1 0");
  EXPECT_EQ(text("insitu:camera.fov_y_deg"), "35.5");
  EXPECT_EQ(text("insitu:camera.height"), "");
  EXPECT_EQ(text("insitu:samples_per_pixel"), "16");
  EXPECT_EQ(text("insitu:max_samples_per_pixel"), "");
  EXPECT_EQ(text("insitu:pixel_error"), "");
  EXPECT_EQ(text("insitu:seconds.build"), "0.0625");
  EXPECT_EQ(text("insitu:seconds.render"), "1.75");

  metadata.camera.kind = INSITU_CAMERA_ORTHOGRAPHIC;
  metadata.camera.height = 12.5;
  metadata.max_samples_per_pixel = 256;
  metadata.pixel_error = 0.01;
  metadata.mean_samples_per_pixel = 21.5;
  metadata.software = "two\nlines \xc3\xa9";
  ASSERT_EQ(write_image(noisy_frame(7, 5, 0), metadata, folder.file("b.png")).status, INSITU_OK);
  const ImageFile second = read_image(folder.file("b.png"));
  EXPECT_EQ(second.spec.get_string_attribute("insitu:camera.kind"), "orthographic");
  EXPECT_EQ(second.spec.get_string_attribute("insitu:camera.height"), "12.5");
  EXPECT_FALSE(second.spec.find_attribute("insitu:camera.fov_y_deg"));
  EXPECT_EQ(second.spec.get_string_attribute("insitu:max_samples_per_pixel"), "256");
  EXPECT_EQ(second.spec.get_string_attribute("insitu:pixel_error"), "0.01");
  EXPECT_EQ(second.spec.get_string_attribute("insitu:mean_samples_per_pixel"), "21.5");
  EXPECT_EQ(second.spec.get_string_attribute("Software"), "two?lines ??");
}

TEST(Png, TextsGoIntoPngFilesOnly) {
  std::vector<unsigned char> bytes(100, 'x');
  const std::vector<unsigned char> before = bytes;
  EXPECT_FALSE(insert_png_texts(bytes, {{"key", "value"}}));
  EXPECT_EQ(bytes, before);
  bytes.clear();
  EXPECT_FALSE(insert_png_texts(bytes, {{"key", "value"}}));
}

TEST(Png, OneInputOneFile) {
  const TemporaryFolder folder;
  const FrameBuffer frame = noisy_frame(33, 17, 0, 0.5f);
  ASSERT_EQ(write_image(frame, some_metadata(), folder.file("a.png")).status, INSITU_OK);
  ASSERT_EQ(write_image(frame, some_metadata(), folder.file("b.PNG")).status, INSITU_OK);
  EXPECT_EQ(testing::bytes_of(folder.file("a.png")), testing::bytes_of(folder.file("b.PNG")));
}

}  // namespace
}  // namespace insitu
