#include "image/framebuffer.h"

#include <gtest/gtest.h>

#include <limits>
#include <new>
#include <stdexcept>

#include "image_test_tools.h"

namespace insitu {
namespace {

using testing::all_channels;

template <class T>
uint64_t bytes(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

uint64_t held_bytes(const FrameBuffer& frame) {
  return bytes(frame.color) + bytes(frame.depth) + bytes(frame.position) + bytes(frame.normal) + bytes(frame.item);
}

TEST(FrameBuffer, HoldsExactlyWhatItSays) {
  for (uint32_t channels = 0; channels <= all_channels; ++channels) {
    FrameBuffer frame;
    frame.allocate(7, 5, channels);
    EXPECT_EQ(held_bytes(frame), FrameBuffer::bytes_for(7, 5, channels)) << channels;
    EXPECT_EQ(frame.channels, channels | INSITU_CHANNEL_COLOR);
  }
  EXPECT_EQ(FrameBuffer::bytes_for(1024, 768, INSITU_CHANNEL_COLOR), 1024u * 768u * 16u);
  EXPECT_EQ(FrameBuffer::bytes_for(10, 10, all_channels), 100u * (16 + 4 + 12 + 12 + 8));
}

TEST(FrameBuffer, SizesThatCannotBeAreNotWrapped) {
  const uint32_t most = std::numeric_limits<uint32_t>::max();
  EXPECT_EQ(FrameBuffer::bytes_for(most, most, all_channels), std::numeric_limits<uint64_t>::max());
  FrameBuffer frame;
  frame.allocate(2, 2, all_channels);
  frame.color[5] = 3.0f;
  EXPECT_THROW(frame.allocate(most, most, all_channels), std::length_error);
  EXPECT_EQ(frame.width, 2u);
  EXPECT_EQ(frame.color.at(5), 3.0f);
}

TEST(FrameBuffer, BeginsAndClearsAsBackground) {
  FrameBuffer frame;
  frame.allocate(3, 2, all_channels);
  const FrameBuffer fresh = frame;
  EXPECT_EQ(frame.color, std::vector<float>(24, 0.0f));
  EXPECT_EQ(frame.depth, std::vector<float>(6, std::numeric_limits<float>::infinity()));
  EXPECT_EQ(frame.position, std::vector<float>(18, 0.0f));
  EXPECT_EQ(frame.normal, std::vector<float>(18, 0.0f));
  EXPECT_EQ(frame.item, std::vector<uint64_t>(6, ~uint64_t{0}));

  frame = testing::noisy_frame(3, 2, all_channels);
  EXPECT_NE(frame.depth, fresh.depth);
  frame.clear();
  EXPECT_EQ(frame.color, fresh.color);
  EXPECT_EQ(frame.depth, fresh.depth);
  EXPECT_EQ(frame.position, fresh.position);
  EXPECT_EQ(frame.normal, fresh.normal);
  EXPECT_EQ(frame.item, fresh.item);
}

TEST(FrameBuffer, GivesMemoryOfChannelsNoLongerWantedBack) {
  FrameBuffer frame;
  frame.allocate(64, 64, all_channels);
  frame.allocate(8, 8, INSITU_CHANNEL_COLOR);
  EXPECT_EQ(held_bytes(frame), FrameBuffer::bytes_for(8, 8, INSITU_CHANNEL_COLOR));
  EXPECT_FALSE(frame.has(INSITU_CHANNEL_DEPTH));
}

}  // namespace
}  // namespace insitu
