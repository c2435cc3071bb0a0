// The library's pictures against those of a ray tracer that shares no line with it.
#include "plain_tracer.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "picture.h"

namespace insitu::golden {
namespace {

class PlainTracer : public ::testing::TestWithParam<const char*> {};

TEST_P(PlainTracer, DrawsTheSamePicture) {
  const Scene scene = scene_named(GetParam());
  const std::filesystem::path folder = INSITU_GOLDEN_RESULTS;
  std::filesystem::create_directories(folder);
  const std::string plain_path = (folder / (scene.name + ".plain.png")).string();
  const std::string library_path = (folder / (scene.name + ".library.png")).string();
  const Picture plain = encoded(width, height, trace_plainly(scene));
  draw(scene, Variant{}, library_path);
  const Difference off = difference(plain, read_png(library_path));
  if (off.max > 1) write_png(plain_path, plain);
  EXPECT_LE(off.max, 1) << "mean " << off.mean << "\n  plain   " << plain_path << "\n  library " << library_path;
}

INSTANTIATE_TEST_SUITE_P(Scenes, PlainTracer, ::testing::Values("shadows", "orthographic"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace insitu::golden
