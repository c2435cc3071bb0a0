#include "geometry/pkd/pkd_build.h"

#include <oneapi/tbb/parallel_invoke.h>

#include "core/float_environment.h"

namespace insitu {
namespace {

using kernels::PkdBox;
using kernels::PkdLayout;
using kernels::PkdTree;

// Particles whose PkdItems fit well into the second level cache of one core.
template <class Key>
constexpr std::uint64_t block_size = (std::uint64_t{512} << 10) / sizeof(PkdItem<Key>);

template <class Store>
struct Halves {
  std::uint64_t mid;
  PkdBox<typename Store::Key> left;
  PkdBox<typename Store::Key> right;
};

template <class Store>
Halves<Store> split(Store& store, std::uint64_t begin, std::uint64_t end, const PkdBox<typename Store::Key>& box) {
  const int axis = box.split_axis();
  const std::uint64_t mid = begin + (end - begin) / 2;
  kernels::select_place(store, begin, end, mid, axis);
  Halves<Store> halves{mid, box, box};
  halves.left.upper[axis] = halves.right.lower[axis] = store.key(mid, axis);
  return halves;
}

// Of particles at one point the one to be shown stands first (kernels/pkd_traverse.cc relies on it).
template <class Store, class Prefer>
void put_preferred_first(Store& store, std::uint64_t begin, std::uint64_t end, Prefer prefer) {
  std::uint64_t best = begin;
  for (std::uint64_t place = begin + 1; place < end; ++place)
    if (prefer(place, best)) best = place;
  store.swap(begin, best);
}

// Builds over [begin, end) on the calling thread.
template <class Store, class Prefer>
void build_serial(Store& store, std::uint64_t begin, std::uint64_t end, PkdBox<typename Store::Key> box,
                  std::uint64_t leaf, const Prefer& prefer) {
  while (end - begin > leaf) {
    if (box.is_point()) return put_preferred_first(store, begin, end, prefer);
    const Halves<Store> halves = split(store, begin, end, box);
    build_serial(store, begin, halves.mid, halves.left, leaf, prefer);
    begin = halves.mid + 1;
    box = halves.right;
  }
}

// Builds a subtree that fits into the cache there, and moves the data once.
template <class Store>
void build_block(Store& store, std::uint64_t begin, std::uint64_t end, const PkdBox<typename Store::Key>& box, std::uint64_t leaf) {
  using Item = PkdItem<typename Store::Key>;
  const auto n = static_cast<std::size_t>(end - begin);
  const std::unique_ptr<Item[]> items(new Item[n]);
  for (std::size_t i = 0; i < n; ++i) {
    for (int axis = 0; axis < 3; ++axis) items[i].x[axis] = store.key(begin + i, axis);
    items[i].local = static_cast<std::uint32_t>(i);
  }
  kernels::RecordStore<Item> scratch(items.get());
  build_serial(scratch, 0, n, box, leaf, [&](std::uint64_t a, std::uint64_t b) {
    return store.prefer(begin + items[a].local, begin + items[b].local);
  });
  store.apply(begin, items.get(), n);
}

template <class Store>
void build_parallel(Store& store, std::uint64_t begin, std::uint64_t end, const PkdBox<typename Store::Key>& box, std::uint64_t leaf) {
  const FloatEnvironment guard;
  if (end - begin <= block_size<typename Store::Key>) return build_block(store, begin, end, box, leaf);
  if (box.is_point())
    return put_preferred_first(store, begin, end, [&](std::uint64_t a, std::uint64_t b) { return store.prefer(a, b); });
  const Halves<Store> halves = split(store, begin, end, box);
  tbb::parallel_invoke([&] { build_parallel(store, begin, halves.mid, halves.left, leaf); },
                       [&] { build_parallel(store, halves.mid + 1, end, halves.right, leaf); });
}

template <class Store>
void build(const PkdTree& tree, Store&& store) {
  if (tree.count <= 1) return;
  using Key = typename std::remove_reference_t<Store>::Key;
  PkdBox<Key> box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = static_cast<Key>(tree.lower[axis]);
    box.upper[axis] = static_cast<Key>(tree.upper[axis]);
  }
  build_parallel(store, 0, tree.count, box, tree.built_leaf);
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
