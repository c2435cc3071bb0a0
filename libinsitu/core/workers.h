// The threads of a context: a TBB arena of its own, as wide as the host grants. TBB's process-wide limits stay as the
// host has set them.
#pragma once

#include <oneapi/tbb/task_arena.h>

#include <utility>

namespace insitu {

class Workers {
 public:
  // 0: as many as the machine has.
  explicit Workers(unsigned max_threads)
      : arena_(max_threads == 0 ? tbb::task_arena::automatic : static_cast<int>(max_threads)) {}

  // Runs `work` within the arena and returns when it is done; the calling thread takes part.
  template <class Work>
  auto run(Work&& work) {
    return arena_.execute(std::forward<Work>(work));
  }

 private:
  tbb::task_arena arena_;
};

}  // namespace insitu
