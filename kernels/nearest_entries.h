// The next items that a ray enters, nearest first, in bounded memory: a ray through any number of layers is followed by
// asking again behind the last one of the list. The list is the same whatever the order in which items are offered.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "kernels/ray.h"

namespace insitu::kernels {

struct EnteredItem {
  double t = -std::numeric_limits<double>::infinity();
  std::uint64_t item = no_item;
  std::uint32_t geometry = 0;  // at the same distance the lower one comes first
  bool is_opaque = false;      // nothing behind it can be seen
};

class NearestEntries {
 public:
  static constexpr std::size_t most = 32;

  // Of everything behind `behind`; its default is in front of everything.
  explicit NearestEntries(const EnteredItem& behind = {}) : behind_(behind) {}

  const EnteredItem& behind() const { return behind_; }
  const EnteredItem* begin() const { return items_; }
  const EnteredItem* end() const { return items_ + count_; }
  std::size_t size() const { return count_; }
  // There may be more behind the last one.
  bool goes_on() const { return count_ == most && !items_[most - 1].is_opaque; }

  // What is farther away is of no use.
  double t_limit() const {
    return count_ == most || is_closed() ? items_[count_ - 1].t : std::numeric_limits<double>::infinity();
  }

  // `prefers(a, b)`: of two items of this geometry at the same distance a comes first. An item may be offered again.
  template <class Prefers>
  void add(const EnteredItem& entered, const Prefers& prefers) {
    if (!is_before(behind_, entered, prefers)) return;
    std::size_t at = count_;
    while (at > 0 && is_before(entered, items_[at - 1], prefers)) --at;
    if (at > 0 && is_same(items_[at - 1], entered)) return;
    if (at == most || (at == count_ && is_closed())) return;
    if (entered.is_opaque) {
      count_ = at + 1;
    } else {
      if (count_ < most) ++count_;
      for (std::size_t i = count_ - 1; i > at; --i) items_[i] = items_[i - 1];
    }
    items_[at] = entered;
  }

 private:
  bool is_closed() const { return count_ > 0 && items_[count_ - 1].is_opaque; }

  static bool is_same(const EnteredItem& a, const EnteredItem& b) {
    return a.t == b.t && a.geometry == b.geometry && a.item == b.item;
  }
  template <class Prefers>
  static bool is_before(const EnteredItem& a, const EnteredItem& b, const Prefers& prefers) {
    if (a.t != b.t) return a.t < b.t;
    return a.geometry != b.geometry ? a.geometry < b.geometry : prefers(a.item, b.item);
  }

  EnteredItem behind_;
  std::size_t count_ = 0;
  EnteredItem items_[most];
};

}  // namespace insitu::kernels
