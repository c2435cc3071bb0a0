// Memory between two pages that must not be touched.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <stdexcept>

namespace insitu::testing {

class GuardedMemory {
 public:
  explicit GuardedMemory(std::size_t bytes) : page_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))) {
    inner_ = (bytes + page_ - 1) / page_ * page_;
    void* all = mmap(nullptr, inner_ + 2 * page_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (all == MAP_FAILED) throw std::runtime_error("mmap");
    all_ = static_cast<std::byte*>(all);
    if (mprotect(all_ + page_, inner_, PROT_READ | PROT_WRITE) != 0) throw std::runtime_error("mprotect");
  }
  ~GuardedMemory() { munmap(all_, inner_ + 2 * page_); }
  GuardedMemory(const GuardedMemory&) = delete;
  GuardedMemory& operator=(const GuardedMemory&) = delete;

  std::byte* begin() const { return all_ + page_; }
  std::byte* end() const { return begin() + inner_; }
  std::size_t size() const { return inner_; }
  // `bytes` that end, or begin, at a forbidden page.
  std::byte* flush(std::size_t bytes, bool at_end) const { return at_end ? end() - bytes : begin(); }

 private:
  std::size_t page_;
  std::size_t inner_ = 0;
  std::byte* all_ = nullptr;
};

}  // namespace insitu::testing
