#include "geometry/pkd/pkd_build.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <atomic>
#include <memory>

#include "geometry/pkd/pkd_mend.h"
#include "geometry/pkd/pkd_split.h"

namespace insitu {
namespace {

using kernels::PkdBox;
using kernels::PkdLayout;
using kernels::PkdTree;

// Particles of a block, which is ordered in scratch memory: its items fill the second level cache of one core.
template <class Key>
constexpr std::uint64_t block_size = (std::uint64_t{1} << 20) / sizeof(PkdItem<Key>);

// Memory of one thread: allocated by the first block that it builds, and used for all.
template <class Key>
class BlockScratch {
 public:
  BlockScratch(std::size_t size, std::size_t bytes_per_item)
      : items(new PkdItem<Key>[size + kernels::run_padding / 4]),
        keys(new Key[size + kernels::list_slack]),
        places(new ListedPlace<Key>[size + kernels::list_slack]),
        bytes(new std::byte[size * bytes_per_item]) {
    // What is read behind the last item is not used, but it shall be a number.
    std::fill_n(items.get() + size, kernels::run_padding / 4, PkdItem<Key>{});
  }
  std::unique_ptr<PkdItem<Key>[]> items;
  std::unique_ptr<Key[]> keys;
  std::unique_ptr<ListedPlace<Key>[]> places;
  std::unique_ptr<std::byte[]> bytes;
};

template <class Store>
class PkdBuild {
 public:
  using Key = typename Store::Key;
  using Box = PkdBox<Key>;

  PkdBuild(Store& store, std::uint64_t count, std::uint64_t leaf)
      : store_(store), leaf_(leaf), scratch_([count] {
          return BlockScratch<Key>(static_cast<std::size_t>(std::min(count, block_size<Key>)), Store::bytes_per_item());
        }) {}

  void build(std::uint64_t begin, std::uint64_t end, const Box& box) {
    const FloatEnvironment guard;
    if (end - begin <= block_size<Key>) return build_block(begin, end, box);
    if (box.is_point()) return put_preferred_first(begin, end);
    const int axis = box.split_axis();
    const std::uint64_t mid = begin + (end - begin) / 2;
    Box left = box;
    Box right = box;
    left.upper[axis] = right.lower[axis] = split_range(store_, {begin, end}, mid, axis, moved_);
    tbb::parallel_invoke([&] { build(begin, mid, left); }, [&] { build(mid + 1, end, right); });
  }

  // The same for particles that are nearly in order. Subtrees that turn out not to be are built.
  void repair(std::uint64_t begin, std::uint64_t end, const Box& box) {
    const FloatEnvironment guard;
    moved_ += TreeMend<Store>(store_, leaf_)
                  .mend(
                      begin, end, box, [this](std::uint64_t b, std::uint64_t e, const Box& of) { build(b, e, of); },
                      [this](std::uint64_t b, std::uint64_t e) { put_preferred_first(b, e); });
  }

  std::uint64_t moved() const { return moved_; }

 private:
  // Orders a subtree in cache, and moves the data once.
  void build_block(std::uint64_t begin, std::uint64_t end, const Box& box) {
    const auto n = static_cast<std::size_t>(end - begin);
    if (n <= leaf_) return;
    BlockScratch<Key>& scratch = scratch_.local();
    PkdItem<Key>* items = scratch.items.get();
    for (std::size_t i = 0; i < n; ++i) {
      for (int axis = 0; axis < 3; ++axis) items[i].x[axis] = store_.key(begin + i, axis);
      items[i].local = static_cast<ListedPlace<Key>>(i);
    }
    struct Block {
      const Store& store;
      std::uint64_t begin;
    } block{store_, begin};
    const auto prefer = [](const void* context, std::uint64_t a, std::uint64_t b) {
      const Block& of = *static_cast<const Block*>(context);
      return of.store.prefer(of.begin + a, of.begin + b);
    };
    kernels::order_items(items, n, box, {scratch.keys.get(), scratch.places.get(), prefer, &block, leaf_});
    std::uint64_t moved = 0;
    for (std::size_t i = 0; i < n; ++i) moved += items[i].local != i ? 1 : 0;
    if (moved == 0) return;
    store_.apply(begin, items, n, scratch.bytes.get());
    moved_ += moved;
  }

  // Of particles at one point the one to be shown stands first (kernels/pkd_traverse.cc relies on it).
  void put_preferred_first(std::uint64_t begin, std::uint64_t end) {
    std::uint64_t best = begin;
    for (std::uint64_t place = begin + 1; place < end; ++place)
      if (store_.prefer(place, best)) best = place;
    if (best == begin) return;
    store_.swap(begin, best);
    moved_ += 2;
  }

  Store& store_;
  const std::uint64_t leaf_;
  tbb::enumerable_thread_specific<BlockScratch<Key>> scratch_;
  std::atomic<std::uint64_t> moved_{0};
};

template <class Store>
PkdBuilt build(const PkdTree& tree, Store&& store, Repair may_repair) {
  if (tree.count <= 1) return {};
  using Stored = typename std::remove_reference_t<Store>;
  PkdBox<typename Stored::Key> box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = static_cast<typename Stored::Key>(tree.lower[axis]);
    box.upper[axis] = static_cast<typename Stored::Key>(tree.upper[axis]);
  }
  PkdBuild<Stored> work(store, tree.count, tree.built_leaf);
  const bool repair = may_repair == Repair::when_nearly_ordered && is_nearly_ordered(tree);
  if (repair) {
    work.repair(0, tree.count, box);
  } else {
    work.build(0, tree.count, box);
  }
  const std::uint64_t moved = work.moved();
  return {!repair ? PkdBuilt::How::built : moved != 0 ? PkdBuilt::How::repaired : PkdBuilt::How::reused, moved};
}

// Only packed coordinates, and nothing that would have to move along.
template <class K>
bool is_packed(const PkdTree& tree, const std::vector<MovedColumn>& columns) {
  const kernels::PlacedPositions<K> positions(tree);
  return positions.packed_records() && columns.size() == 1 && columns[0].bytes == 3 * sizeof(K) && !columns[0].rows;
}

template <class K>
PkdBuilt build_placed(const PkdTree& tree, const std::vector<MovedColumn>& columns, Repair repair) {
  if (is_packed<K>(tree, columns))
    return build(tree, PackedStore<K>(tree, reinterpret_cast<PkdRecord<K>*>(columns[0].base)), repair);
  return build(tree, ColumnsStore<kernels::PlacedPositions<K>>(tree, columns), repair);
}

}  // namespace

namespace {

// Planes are where their particles now are, not where the new medians will be: sides that differ by less than this may
// come out the other way round.
constexpr double clearly_longest = 1.02;

template <class Key>
bool is_clear(const PkdBox<Key>& box, int axis) {
  const auto side = [&box](int of) {
    return static_cast<double>((box.upper[of] - box.lower[of]) * kernels::side_weights<Key>[of]);
  };
  double longest_other = 0.0;
  for (int other = 0; other < 3; ++other)
    if (other != axis) longest_other = std::max(longest_other, side(other));
  return side(axis) > clearly_longest * longest_other;
}

template <class Key>
bool is_ordered_at(const PkdTree& tree, std::uint64_t place, std::uint64_t smallest) {
  double centre[3];
  tree.centre(place, centre);
  PkdBox<Key> box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = static_cast<Key>(tree.lower[axis]);
    box.upper[axis] = static_cast<Key>(tree.upper[axis]);
  }
  for (std::uint64_t begin = 0, end = tree.count; end - begin >= smallest;) {
    const std::uint64_t mid = begin + (end - begin) / 2;
    if (place == mid) return true;
    const int axis = box.split_axis();
    // The root's box is that of the last step, where there was one.
    if (end - begin < tree.count && !is_clear(box, axis)) return true;
    double plane[3];
    tree.centre(mid, plane);
    if (place < mid ? centre[axis] > plane[axis] : centre[axis] < plane[axis]) return false;
    (place < mid ? box.upper : box.lower)[axis] = static_cast<Key>(plane[axis]);
    (place < mid ? end : begin) = place < mid ? mid : mid + 1;
  }
  return true;
}

}  // namespace

bool is_nearly_ordered(const PkdTree& tree) {
  constexpr std::uint64_t fewest = 2048;  // fewer are built as quickly
  constexpr std::uint64_t samples = 256;
  constexpr std::uint64_t most_broken = samples / 4;
  if (tree.count < fewest) return false;
  const auto is_ordered = compares_in_f32(layout_of(tree)) ? is_ordered_at<float> : is_ordered_at<double>;
  std::uint64_t broken = 0;
  for (std::uint64_t i = 0; i < samples && broken <= most_broken; ++i) {
    const std::uint64_t place = (i * 0x9e3779b97f4a7c15 >> 11) % tree.count;
    broken += is_ordered(tree, place, fewest / 4) ? 0 : 1;
  }
  return broken <= most_broken;
}

PkdBuilt build_index(const PkdTree& tree, std::uint32_t* index, Repair repair) {
  switch (layout_of(tree)) {
    case PkdLayout::indexed_f32:
      return build(tree, IndexStore<kernels::IndexedPositions<float>, std::uint32_t>(tree, index), repair);
    case PkdLayout::indexed_f64:
      return build(tree, IndexStore<kernels::IndexedPositions<double>, std::uint32_t>(tree, index), repair);
    default:
      return build(tree, IndexStore<kernels::GeneralPositions, std::uint32_t>(tree, index), repair);
  }
}

PkdBuilt build_index(const PkdTree& tree, std::uint64_t* index, Repair repair) {
  return build(tree, IndexStore<kernels::GeneralPositions, std::uint64_t>(tree, index), repair);
}

PkdBuilt build_columns(const PkdTree& tree, const std::vector<MovedColumn>& columns, Repair repair) {
  switch (layout_of(tree)) {
    case PkdLayout::placed_f32:
      return build_placed<float>(tree, columns, repair);
    case PkdLayout::placed_f64:
      return build_placed<double>(tree, columns, repair);
    default:
      return build(tree, ColumnsStore<kernels::GeneralPositions>(tree, columns), repair);
  }
}

}  // namespace insitu
