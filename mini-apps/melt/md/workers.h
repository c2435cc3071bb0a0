// Loops over several threads whose results do not depend on how many there are.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace melt {

// Work is cut into blocks of `block` items, whatever the number of threads: a sum is then always rounded the same way.
class Workers {
 public:
  static constexpr std::size_t block = 512;

  // 0 threads: as many as the machine has, which is also the most. The caller's thread counts. An arena of its own
  // limits this code alone, and leaves the process-wide settings of TBB to whoever owns them.
  explicit Workers(int threads)
      : arena_(threads > 0 ? std::min(threads, tbb::info::default_concurrency()) : tbb::info::default_concurrency()) {}

  static std::size_t blocks(std::size_t count) { return (count + block - 1) / block; }

  // Calls body(number, begin, end) for every block of [0, count).
  template <class Body>
  void for_each_block(std::size_t count, const Body& body) {
    arena_.execute([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks(count)), [&](const auto& range) {
        for (std::size_t b = range.begin(); b != range.end(); ++b) {
          body(b, b * block, std::min(count, (b + 1) * block));
        }
      });
    });
  }

  // Calls body(i) for every i of [0, count).
  template <class Body>
  void for_each(std::size_t count, const Body& body) {
    for_each_block(count, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  // The sum of term(i) over [0, count): within blocks from first to last, then over the blocks.
  template <class Term>
  double sum(std::size_t count, const Term& term) {
    std::vector<double> partial(blocks(count));
    for_each_block(count, [&](std::size_t b, std::size_t begin, std::size_t end) {
      double s = 0.0;
      for (std::size_t i = begin; i < end; ++i) s += term(i);
      partial[b] = s;
    });
    double total = 0.0;
    for (const double p : partial) total += p;
    return total;
  }

 private:
  tbb::task_arena arena_;
};

}  // namespace melt
