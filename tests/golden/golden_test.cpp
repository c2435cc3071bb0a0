// Golden images. README.md says what they are for and how they are made anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "golden_scene.h"
#include "picture.h"

namespace insitu::golden {

// GoogleTest prints parameters with it.
void PrintTo(const Scene& scene, std::ostream* out) { *out << scene.name; }

namespace {

namespace fs = std::filesystem;

const fs::path references = INSITU_GOLDEN_REFERENCES;
const fs::path results = INSITU_GOLDEN_RESULTS;

bool is_writing() {
  const char* value = std::getenv("INSITU_GOLDEN_WRITE");
  return value != nullptr && std::string(value) == "1";
}

class Golden : public ::testing::TestWithParam<Scene> {};

TEST_P(Golden, LooksLikeItsReference) {
  const Scene& scene = GetParam();
  fs::create_directories(results);
  const fs::path reference_path = references / (scene.name + ".png");
  const fs::path rendered_path = results / (scene.name + ".rendered.png");
  draw(scene, Variant{}, rendered_path.string());
  if (is_writing()) {
    // Written anew from the pixels: the file of the library carries metadata that differ between runs.
    write_png(reference_path.string(), read_png(rendered_path.string()));
    GTEST_SKIP() << "wrote " << reference_path << "; look at it";
  }
  std::ifstream sidecar(references / (scene.name + ".json"));
  ASSERT_TRUE(sidecar) << "no description of " << scene.name;
  const nlohmann::json rule = nlohmann::json::parse(sidecar).at("rule");
  const Picture reference = read_png(reference_path.string());
  const Difference off = difference(reference, read_png(rendered_path.string()));
  if (off.max <= rule.at("max").get<int>() && off.mean <= rule.at("mean").get<double>()) return;
  const fs::path reference_copy = results / (scene.name + ".reference.png");
  const fs::path difference_path = results / (scene.name + ".difference.png");
  write_png(reference_copy.string(), reference);
  write_png(difference_path.string(), off.image);
  ADD_FAILURE() << scene.name << " differs: largest " << off.max << ", mean " << off.mean << ", allowed " << rule.dump()
                << "\n  reference  " << reference_copy << "\n  rendered   " << rendered_path << "\n  difference "
                << difference_path;
}

// Types, layouts, orders and threads are how a scene is handed over, not what it is: not one bit differs.
TEST_P(Golden, LooksTheSameHoweverItIsHandedOver) {
  const Scene& scene = GetParam();
  const std::vector<float> expected = draw(scene, Variant{});
  const Variant variants[] = {
      {true, Layout::records, INSITU_ORDER_INDEX, 1},   {false, Layout::columns, INSITU_ORDER_INDEX, 2},
      {true, Layout::columns, INSITU_ORDER_PERMUTE, 2}, {false, Layout::strided, INSITU_ORDER_PERMUTE, 1},
      {true, Layout::strided, INSITU_ORDER_COPY, 8},    {false, Layout::records, INSITU_ORDER_COPY, 2},
      {true, Layout::records, INSITU_ORDER_PERMUTE, 1}, {false, Layout::records, INSITU_ORDER_PERMUTE, 8}};
  for (const Variant& variant : variants) {
    const std::vector<float> pixels = draw(scene, variant);
    std::size_t differing = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) differing += pixels[i] != expected[i] ? 1 : 0;
    EXPECT_EQ(differing, 0u) << scene.name << ", " << name_of(variant);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Golden, ::testing::ValuesIn(all_scenes()),
                         [](const auto& info) { return info.param.name; });

TEST(GoldenFiles, BelongToScenes) {
  std::size_t found = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(references)) {
    EXPECT_NO_THROW(scene_named(entry.path().stem().string())) << entry.path();
    if (entry.path().extension() != ".png") continue;
    ++found;
    EXPECT_LE(entry.file_size(), 12u * 1024u) << entry.path();
    std::ifstream sidecar(fs::path(entry.path()).replace_extension(".json"));
    ASSERT_TRUE(sidecar) << entry.path() << " has no description";
    EXPECT_FALSE(nlohmann::json::parse(sidecar).at("what").get<std::string>().empty());
  }
  EXPECT_EQ(found, all_scenes().size());
}

// The measure itself: it sees a single byte, and a picture that is moved by a pixel.
TEST(Difference, SeesSmallChanges) {
  Picture a = read_png((references / "shadows.png").string());
  Picture b = a;
  EXPECT_EQ(difference(a, b).max, 0);
  EXPECT_EQ(difference(a, b).mean, 0.0);
  b.rgba[1000] = static_cast<std::uint8_t>(b.rgba[1000] ^ 3);
  EXPECT_GE(difference(a, b).max, 1);
  EXPECT_GT(difference(a, b).mean, 0.0);
  b = a;
  std::rotate(b.rgba.begin(), b.rgba.begin() + 4, b.rgba.end());
  EXPECT_GT(difference(a, b).max, 50);
  b.width = 64;
  EXPECT_EQ(difference(a, b).max, 255);
}

}  // namespace
}  // namespace insitu::golden
