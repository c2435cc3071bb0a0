// Rays handed out tile by tile to the threads of the caller's arena.
#pragma once

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

#include "particle_scenes.h"

namespace bench {

// trace(begin, count) for every run of tile_rays rays.
template <class Trace>
void for_tiles(std::size_t count, const Trace& trace) {
  const std::size_t tiles = (count + tile_rays - 1) / tile_rays;
  tbb::parallel_for(std::size_t{0}, tiles, [&](std::size_t tile) {
    const std::size_t begin = tile * tile_rays;
    trace(begin, std::min(tile_rays, count - begin));
  });
}

}  // namespace bench
