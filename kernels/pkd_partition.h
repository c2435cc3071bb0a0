// Kernels of the build of a P-k-d tree: listing the keys that matter, and ordering a block of particles in cache. Plain
// functions over memory; the best SIMD target of the machine is chosen at run time. pkd_partition_reference.h does the
// same one by one.
//
// The build moves only particles that stand on the wrong side of a split plane (after Edelkamp and Weiss,
// "BlockQuicksort", ESA 2016): SIMD lists their places block by block, and pairs of them are exchanged without a branch
// on the data. The plane itself, the exact median, is found first by reading: keys within a narrow band around a
// sample's median are listed, the others counted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "kernels/pkd_tree.h"

namespace insitu::kernels {

// Coordinates along one axis of consecutive places: key i is first[i * components + axis]; components is 1, 3 or 4.
// With 3 `first` is the first scalar of a record; otherwise axis is 0. With 4 a run is always padded.
template <class Key>
struct KeyRun {
  const Key* first;
  int components;
  bool padded;  // run_padding scalars behind the last record may be read
  int axis = 0;
};
constexpr std::size_t run_padding = 64;

// A place in a list is as wide as a key, so that both fill the same vectors.
template <class Key>
using ListedPlace = std::conditional_t<sizeof(Key) == 4, std::uint32_t, std::uint64_t>;

// Lists are written by whole vectors: they need room for this many entries more than they get.
constexpr std::size_t list_slack = 16;

enum class Relation { less, not_greater, greater, not_less };

template <class Key>
bool holds(Relation relation, Key key, Key pivot) {
  switch (relation) {
    case Relation::less:
      return key < pivot;
    case Relation::not_greater:
      return key <= pivot;
    case Relation::greater:
      return key > pivot;
    case Relation::not_less:
      return key >= pivot;
  }
  return false;
}

// Appends i to `places` for every key i that is `relation` to the pivot, in increasing order; returns how many.
std::size_t list_places(const KeyRun<float>& run, std::size_t count, Relation relation, float pivot,
                        std::uint32_t* places);
std::size_t list_places(const KeyRun<double>& run, std::size_t count, Relation relation, double pivot,
                        std::uint64_t* places);

struct BandCount {
  std::uint64_t below = 0;   // keys below the band
  std::uint64_t inside = 0;  // keys listed
};

// Lists the keys within [low, high], with first_place + i.
BandCount list_band(const KeyRun<float>& run, std::size_t count, float low, float high, std::uint32_t first_place,
                    float* keys, std::uint32_t* places);
BandCount list_band(const KeyRun<double>& run, std::size_t count, double low, double high, std::uint64_t first_place,
                    double* keys, std::uint64_t* places);

template <class Key>
struct Ranked {
  Key key;
  ListedPlace<Key> place;
};

// The entry of the given rank in a list of keys; of equal ones any. The list is destroyed; `count` > rank.
Ranked<float> select_listed(float* keys, std::uint32_t* places, std::size_t count, std::size_t rank);
Ranked<double> select_listed(double* keys, std::uint64_t* places, std::size_t count, std::size_t rank);

// Bounds of packed records x y z x y z ... False when any coordinate is not finite: then they mean nothing.
bool bounds_of_records(const float* first, std::size_t records, float lower[3], float upper[3]);
bool bounds_of_records(const double* first, std::size_t records, double lower[3], double upper[3]);
// The same where all are known to be finite.
void bounds_of_finite_records(const float* first, std::size_t records, float lower[3], float upper[3]);
void bounds_of_finite_records(const double* first, std::size_t records, double lower[3], double upper[3]);

// A particle in the scratch memory of the build: small subtrees are built there, in cache, and applied in one go.
template <class Key>
struct PkdItem {
  Key x[3];
  ListedPlace<Key> local;  // place within the block
};

// Of two particles of a block at the same point: is `a` to be shown?
using PreferLocal = bool (*)(const void* context, std::uint64_t a, std::uint64_t b);

// What ordering a block needs beside the items: lists of as many entries as there are items, and list_slack more.
template <class Key>
struct OrderScratch {
  Key* keys;
  ListedPlace<Key>* places;
  PreferLocal prefer;
  const void* context;
  std::uint64_t leaf = pkd_leaf_size;  // runs of at most so many are left in any order
};

// Puts `count` items, below 2^32, into the order of a tree within `box`. run_padding scalars behind them can be read.
// Items that stand on the right side already stay where they are.
void order_items(PkdItem<float>* items, std::size_t count, const PkdBox<float>& box,
                 const OrderScratch<float>& scratch);
void order_items(PkdItem<double>* items, std::size_t count, const PkdBox<double>& box,
                 const OrderScratch<double>& scratch);

}  // namespace insitu::kernels
