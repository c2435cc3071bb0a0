#include "renderer/renderer.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include "core/float_environment.h"
#include "renderer/tile.h"

namespace insitu {
RenderCosts render_frame(const Scene& scene, const RenderSettings& settings, FrameBuffer& frame) {
  frame.clear();
  const EffectPlan plan = plan_effects(settings.effects, settings.lights, settings.camera, scene.bounds());
  const std::uint32_t tiles_x = (frame.width + tile_edge_px - 1) / tile_edge_px;
  const std::uint32_t tiles_y = (frame.height + tile_edge_px - 1) / tile_edge_px;
  tbb::enumerable_thread_specific<TileRenderer> renderers([&] { return TileRenderer(scene, settings, plan, frame); });
  tbb::parallel_for(std::uint64_t{0}, std::uint64_t{tiles_x} * tiles_y, [&](std::uint64_t tile) {
    const FloatEnvironment guard;
    renderers.local().render(static_cast<std::uint32_t>(tile % tiles_x), static_cast<std::uint32_t>(tile / tiles_x));
  });
  RenderCosts costs;
  for (const TileRenderer& renderer : renderers) costs += renderer.costs();
  return costs;
}

}  // namespace insitu
