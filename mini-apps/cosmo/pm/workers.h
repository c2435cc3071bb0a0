// Loops over several threads whose results do not depend on how many there are.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cosmo {

class Workers {
 public:
  static constexpr std::size_t block = 4096;

  // 0 threads: as many as the machine has, which is also the most. The caller's thread counts. An arena of its own
  // limits this code alone, and leaves the process-wide settings of TBB to whoever owns them.
  explicit Workers(int threads)
      : arena_(threads > 0 ? std::min(threads, tbb::info::default_concurrency()) : tbb::info::default_concurrency()) {}

  // Calls body(i) for every i of [0, count): large pieces of work, such as one plane of a mesh.
  template <class Body>
  void for_each(std::size_t count, const Body& body) {
    arena_.execute([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
      });
    });
  }

  // Calls body(begin, end) for blocks of [0, count), the same blocks whatever the number of threads.
  template <class Body>
  void for_blocks(std::size_t count, const Body& body) {
    for_each((count + block - 1) / block, [&](std::size_t b) { body(b * block, std::min(count, (b + 1) * block)); });
  }

  // The sum of term(i) over [0, count), i being a plane or a block: the terms are added in order, by one thread.
  template <class Term>
  double sum(std::size_t count, const Term& term) {
    std::vector<double> partial(count);
    for_each(count, [&](std::size_t i) { partial[i] = term(i); });
    double total = 0.0;
    for (const double p : partial) total += p;
    return total;
  }

 private:
  tbb::task_arena arena_;
};

}  // namespace cosmo
