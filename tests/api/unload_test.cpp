// The library is loaded, used and unloaded while the program runs, as plugins of simulations are.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "insitu/insitu.h"
#include "temporary_folder.h"

namespace {

template <class Function>
Function* find(void* library, const char* name) {
  auto* function = reinterpret_cast<Function*>(dlsym(library, name));
  EXPECT_NE(function, nullptr) << name;
  return function;
}
#define FIND(name) const auto name##_found = find<decltype(name)>(library, #name)

// A step with two sets (Embree), two threads (TBB) and both kinds of files (OpenImageIO).
void use(void* library) {
  FIND(insitu_context_create);
  FIND(insitu_context_destroy);
  FIND(insitu_error_text);
  FIND(insitu_particles_create);
  FIND(insitu_particles_update);
  FIND(insitu_view_create);
  FIND(insitu_image_create);
  FIND(insitu_step_begin);
  FIND(insitu_commit);
  FIND(insitu_render);
  FIND(insitu_image_write);
  FIND(insitu_step_end);

  insitu_context context = nullptr;
  EXPECT_NE(insitu_context_create_found(nullptr, nullptr), INSITU_OK);
  EXPECT_STRNE(insitu_error_text_found(nullptr), "");
  ASSERT_EQ(insitu_context_create_found(nullptr, &context), INSITU_OK);
  static double xyz[3000];
  for (int i = 0; i < 3000; ++i) xyz[i] = (i * 37 % 101) * 0.01;
  const insitu_array position = insitu_array_records(INSITU_F64, 3, xyz, 1000, 0);
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  insitu_geometry geometries[2];
  for (insitu_geometry& geometry : geometries)
    ASSERT_EQ(insitu_particles_create_found(context, &desc, &geometry), INSITU_OK);
  insitu_view view;
  ASSERT_EQ(insitu_view_create_found(context, nullptr, &view), INSITU_OK);
  insitu_image_desc image_desc;
  insitu_image_desc_init(&image_desc);
  image_desc.width = image_desc.height = 64;
  insitu_image image;
  ASSERT_EQ(insitu_image_create_found(context, &image_desc, &image), INSITU_OK);

  const insitu::testing::TemporaryFolder folder;
  desc.position = &position;
  insitu_step_begin_found(context, 0, 0.0);
  for (const insitu_geometry geometry : geometries) insitu_particles_update_found(context, geometry, &desc);
  insitu_commit_found(context);
  insitu_render_found(context, view, image);
  insitu_image_write_found(context, image, folder.file("a.png").c_str());
  insitu_image_write_found(context, image, folder.file("a.exr").c_str());
  EXPECT_EQ(insitu_step_end_found(context), INSITU_OK) << insitu_error_text_found(context);
  insitu_context_destroy_found(context);
}

TEST(Unload, AndLoadAgain) {
  for (int round = 0; round < 3; ++round) {
    void* library = dlopen(INSITU_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    ASSERT_NE(library, nullptr) << dlerror();
    use(library);
    EXPECT_EQ(dlclose(library), 0);
  }
}

// With the library still loaded the program ends: nothing crashes then either.
TEST(Unload, LeftToTheEnd) {
  void* library = dlopen(INSITU_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  ASSERT_NE(library, nullptr) << dlerror();
  use(library);
}

}  // namespace
