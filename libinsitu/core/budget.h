// Every byte that the library owns on behalf of a context is counted here, before it is allocated.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace insitu {

class Budget {
 public:
  explicit Budget(std::uint64_t cap_bytes) : cap_(cap_bytes) {}

  // Throws Error(over_budget), naming `what`, when the cap would be passed; then nothing is counted.
  void take(std::uint64_t bytes, const char* what);
  void give_back(std::uint64_t bytes) { owned_ -= bytes; }

  std::uint64_t owned() const { return owned_; }
  std::uint64_t peak() const { return peak_; }
  std::uint64_t left() const { return cap_ == 0 ? ~std::uint64_t{0} : cap_ - owned_; }

 private:
  std::uint64_t cap_;  // 0: none
  std::uint64_t owned_ = 0;
  std::uint64_t peak_ = 0;
};

// Bytes held in a budget for as long as this object lives.
class BudgetShare {
 public:
  BudgetShare() = default;
  BudgetShare(Budget& budget, std::uint64_t bytes, const char* what) : budget_(&budget), bytes_(bytes) {
    budget.take(bytes, what);
  }
  BudgetShare(BudgetShare&& other) noexcept
      : budget_(std::exchange(other.budget_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
  BudgetShare& operator=(BudgetShare&& other) noexcept {
    std::swap(budget_, other.budget_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  BudgetShare(const BudgetShare&) = delete;
  BudgetShare& operator=(const BudgetShare&) = delete;
  ~BudgetShare() {
    if (budget_ != nullptr) budget_->give_back(bytes_);
  }
  std::uint64_t bytes() const { return bytes_; }

 private:
  Budget* budget_ = nullptr;
  std::uint64_t bytes_ = 0;
};

// A vector whose bytes are counted. It only grows by assignment of a new size: contents are not kept.
template <class T>
class BudgetVector {
 public:
  BudgetVector() = default;

  // A change of size frees the old memory first, so that the peak is what is held, not twice that.
  void reset(Budget& budget, std::uint64_t size, const char* what) {
    if (size == values_.size()) return;
    clear();
    BudgetShare share(budget, size * sizeof(T), what);
    values_ = std::vector<T>(size);
    share_ = std::move(share);
  }
  void clear() {
    values_ = {};
    share_ = {};
  }
  T* data() { return values_.data(); }
  const T* data() const { return values_.data(); }
  std::uint64_t size() const { return values_.size(); }
  bool empty() const { return values_.empty(); }
  std::uint64_t bytes() const { return share_.bytes(); }

 private:
  BudgetShare share_;
  std::vector<T> values_;
};

}  // namespace insitu
