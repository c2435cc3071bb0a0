// Address space by the hundred gigabytes, of which only the pages that are written take memory: everything else reads
// as zero. For tests of places and offsets that 32 bits do not hold.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>

namespace insitu::testing {

class HugeMemory {
 public:
  explicit HugeMemory(std::uint64_t bytes) : bytes_(bytes) {
    void* at = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (at == MAP_FAILED) return;
    base_ = static_cast<std::byte*>(at);
    madvise(at, bytes, MADV_NOHUGEPAGE);
  }
  ~HugeMemory() {
    if (base_ != nullptr) munmap(base_, bytes_);
  }
  HugeMemory(const HugeMemory&) = delete;
  HugeMemory& operator=(const HugeMemory&) = delete;

  // False where the address space is limited (ulimit -v) or memory is never overcommitted.
  bool exists() const { return base_ != nullptr; }
  std::byte* data() const { return base_; }
  template <class T>
  T* as() const {
    return reinterpret_cast<T*>(base_);
  }

 private:
  std::byte* base_ = nullptr;
  std::uint64_t bytes_;
};

constexpr const char* no_address_space = "SKIPPED: the address space is limited, a few hundred gigabytes are needed";

}  // namespace insitu::testing
