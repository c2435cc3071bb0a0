// Reading the permutation back, undoing it, and the checksum that shows that records stayed whole.
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include "core/error.h"
#include "geometry/particles/particles.h"

namespace insitu {

void Particles::permutation(std::uint64_t* original, std::uint64_t count) const {
  if (!built_) throw Error(INSITU_ERROR_WRONG_STATE, name_ + ": there is no permutation before insitu_commit");
  const std::uint64_t items = item_count();
  if (count < items)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, name_ + ": the permutation has " + std::to_string(items) +
                                                   " entries, there is room for " + std::to_string(count));
  const auto listed = [this](std::uint64_t place) {
    return index32_.empty() ? index64_.data()[place] : std::uint64_t{index32_.data()[place]};
  };
  if (order_ == ParticleOrder::permute) {
    if (!keep_permutation_)
      throw Error(INSITU_ERROR_WRONG_STATE, name_ + ": created without INSITU_PARTICLES_KEEP_PERMUTATION");
    for (std::uint64_t place = 0; place < items; ++place) original[place] = listed(place);
    return;
  }
  // The index lists the drawn items; the others follow.
  std::vector<bool> is_listed(items, false);
  for (std::uint64_t place = 0; place < tree_.count; ++place) {
    original[place] = listed(place);
    is_listed[original[place]] = true;
  }
  std::uint64_t next = tree_.count;
  for (std::uint64_t item = 0; item < items; ++item)
    if (!is_listed[item]) original[next++] = item;
}

void Particles::restore_order() {
  if (order_ != ParticleOrder::permute || !keep_permutation_)
    throw Error(INSITU_ERROR_WRONG_STATE,
                name_ + ": only sets with INSITU_ORDER_PERMUTE and INSITU_PARTICLES_KEEP_PERMUTATION can be put back");
  if (!built_) throw Error(INSITU_ERROR_WRONG_STATE, name_ + ": nothing has been permuted since the step began");
  // Cycle by cycle: every swap puts one record home, and its entry says so.
  const auto restore = [this](auto* from, std::uint64_t count) {
    const std::vector<MovedColumn>& columns = moved_.columns();
    ColumnsStore<kernels::GeneralPositions> store(tree_, columns);
    for (std::uint64_t place = 0; place < count; ++place) {
      while (from[place] != place) {
        const std::uint64_t home = from[place];
        store.swap(place, home);
        std::swap(from[place], from[home]);
      }
    }
  };
  const std::uint64_t items = item_count();
  if (index32_.empty()) {
    restore(index64_.data(), items);
  } else {
    restore(index32_.data(), items);
  }
  release();
}

namespace {

// FNV-1a over the bytes of one item, stirred at the end so that sums of it keep their quality.
std::uint64_t hash_bytes(std::uint64_t hash, const std::byte* bytes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) hash = (hash ^ static_cast<std::uint64_t>(bytes[i])) * 0x100000001b3;
  return hash;
}

std::uint64_t stir(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

}  // namespace

std::uint64_t Particles::checksum() const {
  if (!arrays_) return 0;
  std::vector<const kernels::ArrayView*> views = {&arrays_->position};
  if (arrays_->radius) views.push_back(&*arrays_->radius);
  if (arrays_->type) views.push_back(&*arrays_->type);
  for (const NamedView& attribute : arrays_->attributes) views.push_back(&attribute.view);
  for (const kernels::ArrayView& payload : arrays_->payload) views.push_back(&payload);

  const auto record = [&](std::uint64_t item) {
    std::uint64_t hash = 0xcbf29ce484222325;
    for (const kernels::ArrayView* view : views) {
      const std::size_t size = kernels::size_of(view->type);
      if (view->components > 4) {
        hash = hash_bytes(hash, view->address(item, 0), view->components * size);
      } else {
        for (std::uint32_t c = 0; c < view->components; ++c) hash = hash_bytes(hash, view->address(item, c), size);
      }
    }
    return stir(hash);
  };
  return tbb::parallel_reduce(
      tbb::blocked_range<std::uint64_t>(0, item_count(), 1 << 14), std::uint64_t{0},
      [&](const auto& range, std::uint64_t sum) {
        for (std::uint64_t item = range.begin(); item < range.end(); ++item) sum += record(item);
        return sum;
      },
      [](std::uint64_t a, std::uint64_t b) { return a + b; });
}

}  // namespace insitu
