#include "geometry/pkd/pkd_build.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <memory>

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
    left.upper[axis] = right.lower[axis] = split_range(store_, {begin, end}, mid, axis);
    tbb::parallel_invoke([&] { build(begin, mid, left); }, [&] { build(mid + 1, end, right); });
  }

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
    store_.apply(begin, items, n, scratch.bytes.get());
  }

  // Of particles at one point the one to be shown stands first (kernels/pkd_traverse.cc relies on it).
  void put_preferred_first(std::uint64_t begin, std::uint64_t end) {
    std::uint64_t best = begin;
    for (std::uint64_t place = begin + 1; place < end; ++place)
      if (store_.prefer(place, best)) best = place;
    store_.swap(begin, best);
  }

  Store& store_;
  const std::uint64_t leaf_;
  tbb::enumerable_thread_specific<BlockScratch<Key>> scratch_;
};

template <class Store>
void build(const PkdTree& tree, Store&& store) {
  if (tree.count <= 1) return;
  using Stored = typename std::remove_reference_t<Store>;
  PkdBox<typename Stored::Key> box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = static_cast<typename Stored::Key>(tree.lower[axis]);
    box.upper[axis] = static_cast<typename Stored::Key>(tree.upper[axis]);
  }
  PkdBuild<Stored>(store, tree.count, tree.built_leaf).build(0, tree.count, box);
}

// Only packed coordinates, and nothing that would have to move along.
template <class K>
bool is_packed(const PkdTree& tree, const std::vector<MovedColumn>& columns) {
  const kernels::PlacedPositions<K> positions(tree);
  return positions.packed_records() && columns.size() == 1 && columns[0].bytes == 3 * sizeof(K) && !columns[0].rows;
}

template <class K>
void build_placed(const PkdTree& tree, const std::vector<MovedColumn>& columns) {
  if (is_packed<K>(tree, columns))
    return build(tree, PackedStore<K>(tree, reinterpret_cast<PkdRecord<K>*>(columns[0].base)));
  build(tree, ColumnsStore<kernels::PlacedPositions<K>>(tree, columns));
}

}  // namespace

void build_index(const PkdTree& tree, std::uint32_t* index) {
  switch (layout_of(tree)) {
    case PkdLayout::indexed_f32:
      return build(tree, IndexStore<kernels::IndexedPositions<float>, std::uint32_t>(tree, index));
    case PkdLayout::indexed_f64:
      return build(tree, IndexStore<kernels::IndexedPositions<double>, std::uint32_t>(tree, index));
    default:
      return build(tree, IndexStore<kernels::GeneralPositions, std::uint32_t>(tree, index));
  }
}

void build_index(const PkdTree& tree, std::uint64_t* index) {
  build(tree, IndexStore<kernels::GeneralPositions, std::uint64_t>(tree, index));
}

void build_columns(const PkdTree& tree, const std::vector<MovedColumn>& columns) {
  switch (layout_of(tree)) {
    case PkdLayout::placed_f32:
      return build_placed<float>(tree, columns);
    case PkdLayout::placed_f64:
      return build_placed<double>(tree, columns);
    default:
      return build(tree, ColumnsStore<kernels::GeneralPositions>(tree, columns));
  }
}

}  // namespace insitu
