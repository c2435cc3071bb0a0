// The threads of a context: a TBB arena of its own, as wide as the host grants. TBB's process-wide limits stay as the
// host has set them.
#pragma once

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace insitu {

class Workers {
 public:
  // 0: as many as the machine has. Never more than TBB may use in this process: it would say so on stderr.
  explicit Workers(unsigned max_threads) : arena_(width(max_threads)) {}

  // Runs `work` within the arena and returns when it is done; the calling thread takes part.
  template <class Work>
  auto run(Work&& work) {
    return arena_.execute(std::forward<Work>(work));
  }

 private:
  static int width(unsigned max_threads) {
    if (max_threads == 0) return tbb::task_arena::automatic;
    const std::size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    return static_cast<int>(std::min<std::size_t>(max_threads, std::max<std::size_t>(allowed, 1)));
  }

  tbb::task_arena arena_;
};

}  // namespace insitu
