// Contexts are independent: they write at the same time, also to the same folder and the same file.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "image/image_writer.h"
#include "image_test_tools.h"

namespace insitu {
namespace {

using testing::all_channels;
using testing::noisy_frame;
using testing::some_metadata;
using testing::TemporaryFolder;

TEST(ConcurrentWrite, ManyWritersOneFolder) {
  const TemporaryFolder folder;
  int exr_threads_before = 0;
  OIIO::getattribute("exr_threads", exr_threads_before);
  constexpr int writer_count = 4;
  constexpr int round_count = 8;
  std::atomic<int> failures{0};
  {
    std::vector<std::jthread> writers;
    for (int writer = 0; writer < writer_count; ++writer) {
      writers.emplace_back([&folder, &failures, writer] {
        const FrameBuffer frame = noisy_frame(40, 30, all_channels);
        for (int round = 0; round < round_count; ++round) {
          const std::string own = "own" + std::to_string(writer) + (round % 2 ? ".png" : ".exr");
          for (const std::string& name : {own, std::string("shared.png"), std::string("shared.exr")}) {
            if (write_image(frame, some_metadata(), folder.file(name)).status != INSITU_OK) ++failures;
          }
        }
      });
    }
  }
  EXPECT_EQ(failures, 0);
  int exr_threads_after = 0;
  OIIO::getattribute("exr_threads", exr_threads_after);
  EXPECT_EQ(exr_threads_after, exr_threads_before);

  EXPECT_EQ(folder.names().size(), 2u * writer_count + 2u) << "temporary files are left";
  for (int writer = 0; writer < writer_count; ++writer) {
    const std::string own = "own" + std::to_string(writer);
    EXPECT_EQ(testing::bytes_of(folder.file(own + ".png")), testing::bytes_of(folder.file("shared.png")));
    EXPECT_EQ(testing::bytes_of(folder.file(own + ".exr")), testing::bytes_of(folder.file("shared.exr")));
  }
}

}  // namespace
}  // namespace insitu
