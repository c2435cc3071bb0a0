// The part of TBB that this project uses, made of std::thread.
//
// ThreadSanitizer cannot see how Debian's libtbb hands tasks from thread to thread, because it is not instrumented, and
// takes every hand-over for a race. In the tsan preset this header stands in the place of TBB's: same interface, and
// all synchronisation is what ThreadSanitizer knows: a thread starts and is joined. Each thread has its fixed share of
// a loop and nothing orders the shares, so that two that touch the same memory are found even when they happen to run
// one after the other. Slow, and meant to be used for this only.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace tbb {

struct split {};

template <class Value>
class blocked_range {
 public:
  using const_iterator = Value;
  using size_type = std::size_t;
  blocked_range(Value begin, Value end, size_type grainsize = 1) : begin_(begin), end_(end), grain_(grainsize) {}
  Value begin() const { return begin_; }
  Value end() const { return end_; }
  size_type size() const { return static_cast<size_type>(end_ - begin_); }
  size_type grainsize() const { return grain_; }
  bool empty() const { return !(begin_ < end_); }

 private:
  Value begin_;
  Value end_;
  size_type grain_;
};

struct auto_partitioner {};
struct simple_partitioner {};
struct static_partitioner {};

namespace threads_only {

inline thread_local int arena_width = 0;  // 0: as many as the machine has
inline thread_local int worker_index = 0;

inline std::mutex limit_mutex;
inline std::multiset<std::size_t> limits;  // of the global_controls that are alive

inline int width() {
  const int wanted = arena_width > 0 ? arena_width : std::max(2, static_cast<int>(std::thread::hardware_concurrency()));
  const std::lock_guard lock(limit_mutex);
  return limits.empty() ? wanted : std::min(wanted, static_cast<int>(*limits.begin()));
}

// Runs work(0) ... work(n - 1), each on a thread of its own but the first, and rethrows the first exception.
template <class Work>
void run(std::size_t n, const Work& work) {
  std::vector<std::exception_ptr> errors(n);
  const int inherited = arena_width;
  const auto guarded = [&](std::size_t index) {
    try {
      work(index);
    } catch (...) {
      errors[index] = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < n; ++i) {
    others.emplace_back([&, i] {
      arena_width = inherited;
      worker_index = static_cast<int>(i);
      guarded(i);
    });
  }
  if (n > 0) guarded(0);
  for (std::thread& other : others) other.join();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

// At most this many threads of nested parallel_invoke at a time; past it the work is done where it is asked for.
inline std::atomic<int> invoked{0};

template <class Value>
std::size_t chunk_size(const blocked_range<Value>& range) {
  return std::max<std::size_t>(range.grainsize(), (range.size() + 255) / 256);
}

template <class Value>
std::size_t chunk_count(const blocked_range<Value>& range) {
  return range.empty() ? 0 : (range.size() + chunk_size(range) - 1) / chunk_size(range);
}

// Calls body(i, chunk i) for consecutive chunks of the range, by at most width() threads.
template <class Value, class Body>
void for_chunks(const blocked_range<Value>& range, const Body& body) {
  const std::size_t size = chunk_size(range);
  const std::size_t chunks = chunk_count(range);
  const std::size_t threads = std::min(chunks, static_cast<std::size_t>(width()));
  run(threads, [&](std::size_t thread) {
    for (std::size_t i = thread; i < chunks; i += threads) {
      const Value begin = range.begin() + static_cast<Value>(i * size);
      const Value end = i + 1 == chunks ? range.end() : begin + static_cast<Value>(size);
      body(i, blocked_range<Value>(begin, end, range.grainsize()));
    }
  });
}

}  // namespace threads_only

template <class Value, class Body, class... Partitioner>
void parallel_for(const blocked_range<Value>& range, const Body& body, const Partitioner&...) {
  threads_only::for_chunks(range, [&](std::size_t, const blocked_range<Value>& chunk) { body(chunk); });
}

template <class Index, class Body>
requires std::is_integral_v<Index>
void parallel_for(Index first, Index last, const Body& body) {
  parallel_for(blocked_range<Index>(first, last), [&](const blocked_range<Index>& chunk) {
    for (Index i = chunk.begin(); i != chunk.end(); ++i) body(i);
  });
}

template <class Range, class Value, class Body, class Join, class... Partitioner>
Value parallel_reduce(const Range& range, const Value& identity, const Body& body, const Join& join,
                      const Partitioner&...) {
  std::vector<std::optional<Value>> parts(threads_only::chunk_count(range));
  threads_only::for_chunks(range, [&](std::size_t i, const Range& chunk) { parts[i] = body(chunk, identity); });
  Value result = identity;
  for (const std::optional<Value>& part : parts) result = join(result, *part);
  return result;
}

template <class Range, class Value, class Body, class Join>
Value parallel_deterministic_reduce(const Range& range, const Value& identity, const Body& body, const Join& join) {
  return parallel_reduce(range, identity, body, join);
}

template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  if (threads_only::invoked.fetch_add(1, std::memory_order_relaxed) < threads_only::width() - 1) {
    threads_only::run(2, [&](std::size_t index) { index == 0 ? second() : first(); });
  } else {
    first();
    second();
  }
  threads_only::invoked.fetch_sub(1, std::memory_order_relaxed);
}

class task_arena {
 public:
  static constexpr int automatic = -1;
  explicit task_arena(int max_concurrency = automatic, unsigned = 1) : width_(std::max(0, max_concurrency)) {}
  void initialize() {}
  void terminate() {}
  bool is_active() const { return true; }
  int max_concurrency() const { return width_ > 0 ? width_ : threads_only::width(); }

  template <class Work>
  auto execute(Work&& work) {
    struct Restore {
      int width = threads_only::arena_width;
      ~Restore() { threads_only::arena_width = width; }
    } restore;
    threads_only::arena_width = width_;
    return std::forward<Work>(work)();
  }

 private:
  int width_;
};

namespace this_task_arena {
inline int max_concurrency() { return threads_only::width(); }
inline int current_thread_index() { return threads_only::worker_index; }
template <class Work>
auto isolate(Work&& work) {
  return std::forward<Work>(work)();
}
}  // namespace this_task_arena

template <class T>
class enumerable_thread_specific {
 public:
  using iterator = typename std::list<T>::iterator;
  enumerable_thread_specific() : make_([] { return T(); }) {}
  template <class Make>
  requires std::is_invocable_r_v<T, Make>
  explicit enumerable_thread_specific(Make make) : make_(std::move(make)) {}
  explicit enumerable_thread_specific(const T& exemplar) : make_([exemplar] { return exemplar; }) {}

  // Each thread takes the lock once: a lock in every call would put the calls of all threads into an order.
  T& local() {
    thread_local std::uint64_t owner = 0;
    thread_local T* mine = nullptr;
    if (owner != id_) {
      const std::lock_guard lock(*mutex_);
      auto [at, is_new] = of_thread_.try_emplace(std::this_thread::get_id(), nullptr);
      if (is_new) at->second = &values_.emplace_back(make_());
      mine = at->second;
      owner = id_;
    }
    return *mine;
  }
  iterator begin() { return values_.begin(); }
  iterator end() { return values_.end(); }
  std::size_t size() const { return values_.size(); }

 private:
  static inline std::atomic<std::uint64_t> last_id_{0};
  const std::uint64_t id_ = ++last_id_;
  std::function<T()> make_;
  // On the heap: ThreadSanitizer hangs now and then on a mutex whose place on a stack was something else before.
  const std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
  std::map<std::thread::id, T*> of_thread_;
  std::list<T> values_;
};

class global_control {
 public:
  enum parameter { max_allowed_parallelism, thread_stack_size };
  global_control(parameter what, std::size_t value) : what_(what), value_(value) {
    const std::lock_guard lock(threads_only::limit_mutex);
    if (what_ == max_allowed_parallelism) threads_only::limits.insert(value_);
  }
  ~global_control() {
    const std::lock_guard lock(threads_only::limit_mutex);
    if (what_ == max_allowed_parallelism) threads_only::limits.erase(threads_only::limits.find(value_));
  }
  global_control(const global_control&) = delete;
  global_control& operator=(const global_control&) = delete;
  static std::size_t active_value(parameter what) {
    const std::lock_guard lock(threads_only::limit_mutex);
    if (what == thread_stack_size) return std::size_t{8} << 20;
    return threads_only::limits.empty() ? std::thread::hardware_concurrency() : *threads_only::limits.begin();
  }

 private:
  parameter what_;
  std::size_t value_;
};

namespace info {
inline int default_concurrency() { return static_cast<int>(std::thread::hardware_concurrency()); }
}  // namespace info

}  // namespace tbb

namespace oneapi {
namespace tbb = ::tbb;
}
