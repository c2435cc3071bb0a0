// Mending a tree whose particles are nearly in order, where they stand: the bounds of all subtrees, down to short runs
// of places, tell at each split whether a particle stands on the wrong side of it, and where. Where none does, which is
// the rule, no particle is read.
//
// A split is in order when its particle has the median key, whatever the particles do: as many stand on either side as
// always. So only those on the wrong side matter, and where they are not as many on one side as on the other, the few
// that the median then moves across. The result obeys the same rules as a build from scratch, and does not depend on
// the number of threads.
#pragma once

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "core/float_environment.h"
#include "geometry/pkd/pkd_bounds.h"
#include "geometry/pkd/pkd_store.h"

namespace insitu {

template <class Store>
class TreeMend {
 public:
  using Key = typename Store::Key;
  using Box = kernels::PkdBox<Key>;

  // `leaf`: as PkdTree::built_leaf. Of more levels than `most_height`, whose nodes take 40 MB, the lower ones are
  // mended for one run of particles after another.
  TreeMend(Store& store, std::uint64_t leaf, unsigned most_height = 20)
      : store_(store), leaf_(leaf), most_height_(most_height) {}

  // Orders [begin, end). Subtrees with much out of order are left to build(begin, end, box), those at one point to
  // put_preferred_first(begin, end). Returns how many particles moved, but for these.
  template <class Build, class PutPreferredFirst>
  std::uint64_t mend(std::uint64_t begin, std::uint64_t end, const Box& box, const Build& build,
                     const PutPreferredFirst& put_preferred_first) {
    run_ = leaf_;
    if (height_for(end - begin) > most_height_) run_ *= 128;
    const unsigned height = height_for(end - begin);
    // Not set to anything: the threads that fit them write all of them.
    nodes_.reset(new Known[(std::size_t{1} << height) - 1]);
    const Node root = {begin, end, 0, height};
    fit(root);
    mend(root, box, build, put_preferred_first);
    std::uint64_t moved = 0;
    for (const Lists& lists : lists_) moved += lists.moved;
    return moved;
  }

 private:
  using Place = ListedPlace<Key>;

  // A complete tree of `height` levels, each subtree of which is one piece of nodes_: the mending goes through both
  // nodes and particles from front to back.
  struct Node {
    std::uint64_t begin;
    std::uint64_t end;
    std::size_t index;
    unsigned height;

    std::uint64_t size() const { return end - begin; }
    std::uint64_t mid() const { return begin + (end - begin) / 2; }
    Node left() const { return {begin, mid(), index + 1, height - 1}; }
    Node right() const { return {mid() + 1, end, index + (std::size_t{1} << (height - 1)), height - 1}; }
  };
  struct Known {
    Box box;     // of all particles
    Key own[3];  // the particle of the split
  };
  struct Keyed {
    Key key;
    std::uint64_t place;
  };
  // Working memory of one thread.
  struct Lists {
    std::vector<std::uint64_t> above;  // left of a split, with keys above it
    std::vector<std::uint64_t> below;  // right of a split, with keys below it
    std::vector<std::uint64_t> others;
    std::vector<kernels::PlaceRange> runs;
    std::vector<Keyed> keyed;
    std::size_t most = 0;     // entries, before building is quicker
    std::uint64_t moved = 0;  // particles
  };
  static constexpr std::uint64_t fewest_for_a_task = 16384;

  unsigned height_for(std::uint64_t places) const {
    unsigned height = 1;
    for (; places > run_; places /= 2) ++height;
    return height;
  }
  bool is_run(const Node& node) const { return node.size() <= run_; }

  template <class First, class Second>
  static void both(const Node& node, const First& first, const Second& second) {
    if (node.size() < fewest_for_a_task) {
      first();
      second();
      return;
    }
    const auto guarded = [](const auto& work) {
      const FloatEnvironment guard;
      work();
    };
    tbb::parallel_invoke([&] { guarded(first); }, [&] { guarded(second); });
  }

  void fit(const Node& node) {
    if (is_run(node)) {
      nodes_[node.index].box = bounds_of_places(store_, node.begin, node.end);
      return;
    }
    both(
        node, [&] { fit(node.left()); }, [&] { fit(node.right()); });
    read_own(node);
    fit_to_parts(node);
  }

  void read_own(const Node& node) {
    for (int axis = 0; axis < 3; ++axis) nodes_[node.index].own[axis] = store_.key(node.mid(), axis);
  }

  void fit_to_parts(const Node& node) {
    const Box& left = nodes_[node.left().index].box;
    const Box& right = nodes_[node.right().index].box;
    Known& known = nodes_[node.index];
    for (int axis = 0; axis < 3; ++axis) {
      known.box.lower[axis] = std::min({left.lower[axis], right.lower[axis], known.own[axis]});
      known.box.upper[axis] = std::max({left.upper[axis], right.upper[axis], known.own[axis]});
    }
  }

  // The same again after the particles at some places, in increasing order, have become others.
  void fit_again(const Node& node, const std::uint64_t* first, const std::uint64_t* last) {
    if (first == last) return;
    if (is_run(node)) return fit(node);
    const std::uint64_t* not_left = std::lower_bound(first, last, node.mid());
    fit_again(node.left(), first, not_left);
    if (not_left != last && *not_left == node.mid()) {
      read_own(node);
      ++not_left;
    }
    fit_again(node.right(), not_left, last);
    fit_to_parts(node);
  }

  template <class Build, class PutPreferredFirst>
  void mend(const Node& node, const Box& box, const Build& build, const PutPreferredFirst& put_preferred_first) {
    if (node.size() < fewest_for_a_task) {
      Lists& lists = lists_.local();  // of this thread alone: below, nothing waits for tasks
      return mend_alone(node, box, lists, build, put_preferred_first);
    }
    Box left;
    Box right;
    if (!mend_split(node, box, lists_.local(), left, right, build, put_preferred_first)) return;
    both(
        node, [&] { mend(node.left(), left, build, put_preferred_first); },
        [&] { mend(node.right(), right, build, put_preferred_first); });
  }

  template <class Build, class PutPreferredFirst>
  void mend_alone(const Node& node, const Box& box, Lists& lists, const Build& build,
                  const PutPreferredFirst& put_preferred_first) {
    if (is_run(node)) {
      if (node.size() <= leaf_) return;
      TreeMend part(store_, leaf_);
      lists.moved += part.mend(node.begin, node.end, box, build, put_preferred_first);
      return;
    }
    Box left;
    Box right;
    if (!mend_split(node, box, lists, left, right, build, put_preferred_first)) return;
    mend_alone(node.left(), left, lists, build, put_preferred_first);
    mend_alone(node.right(), right, lists, build, put_preferred_first);
  }

  // False: the subtree is done.
  template <class Build, class PutPreferredFirst>
  bool mend_split(const Node& node, const Box& box, Lists& lists, Box& left, Box& right, const Build& build,
                  const PutPreferredFirst& put_preferred_first) {
    if (box.is_point()) {
      put_preferred_first(node.begin, node.end);
      return false;
    }
    const int axis = box.split_axis();
    if (!is_split(node, axis) && !(node.size() / 2 <= leaf_ && split_leaves(node, axis, lists)) &&
        !split(node, axis, lists)) {
      build(node.begin, node.end, box);
      return false;
    }
    left = box;
    right = box;
    left.upper[axis] = right.lower[axis] = nodes_[node.index].own[axis];
    return true;
  }

  bool is_split(const Node& node, int axis) const {
    const Key plane = nodes_[node.index].own[axis];
    return nodes_[node.left().index].box.upper[axis] <= plane && nodes_[node.right().index].box.lower[axis] >= plane;
  }

  // The split above two leaves, where it takes exchanges of pairs and at most the next particle as the new median.
  // False, and nothing has moved, when it takes more.
  bool split_leaves(const Node& node, int axis, Lists& lists) {
    using kernels::Relation;
    const Node left = node.left();
    const Node right = node.right();
    const Key plane = nodes_[node.index].own[axis];
    Place above[kernels::pkd_leaf_size + kernels::list_slack];
    Place below[kernels::pkd_leaf_size + 1 + kernels::list_slack];
    std::size_t n_above =
        store_.list(left.begin, static_cast<std::size_t>(left.size()), axis, Relation::greater, plane, above);
    std::size_t n_below =
        store_.list(right.begin, static_cast<std::size_t>(right.size()), axis, Relation::less, plane, below);
    if (n_above == n_below + 1) {
      take_next<true>(node, left, above, n_above, right, below, n_below, axis, lists);
    } else if (n_below == n_above + 1) {
      take_next<false>(node, right, below, n_below, left, above, n_above, axis, lists);
    } else if (n_above != n_below) {
      return false;
    }
    store_.exchange(left.begin, above, right.begin, below, n_above);
    lists.moved += 2 * n_above;
    return true;
  }

  // The next median is the nearest particle behind the old one: one of those listed `here`, which have to pass it, or
  // one of the `other` leaf. Then both lists are as long as the shorter, or the longer.
  template <bool up>
  void take_next(const Node& node, const Node& leaf, Place* here, std::size_t& n_here, const Node& other, Place* there,
                 std::size_t& n_there, int axis, Lists& lists) {
    const Key plane = nodes_[node.index].own[axis];
    std::size_t nearest = 0;
    Key key = store_.key(leaf.begin + here[0], axis);
    for (std::size_t i = 1; i < n_here; ++i) {
      const Key one = store_.key(leaf.begin + here[i], axis);
      if (up ? one < key : one > key) {
        key = one;
        nearest = i;
      }
    }
    std::uint64_t from = leaf.begin + here[nearest];
    bool from_other = false;
    for (std::uint64_t place = other.begin; place < other.end; ++place) {
      const Key one = store_.key(place, axis);
      if (up ? one >= plane && one < key : one <= plane && one > key) {
        key = one;
        from = place;
        from_other = true;
      }
    }
    store_.swap(node.mid(), from);
    lists.moved += 2;
    read_own(node);
    if (from_other) {
      // The old median, which is there now, changes sides.
      there[n_there++] = static_cast<Place>(from - other.begin);
    } else {
      here[nearest] = here[--n_here];
    }
  }

  // False when so many are out of order that building is quicker; what has moved until then does no harm.
  bool split(const Node& node, int axis, Lists& lists) {
    using kernels::Relation;
    lists.most = static_cast<std::size_t>(node.size() / 4 + 16);
    const Key plane = nodes_[node.index].own[axis];
    if (!list(node.left(), axis, Relation::greater, plane, lists, lists.above)) return false;
    if (!list(node.right(), axis, Relation::less, plane, lists, lists.below)) return false;
    if (lists.above.size() > lists.below.size()) {
      if (!move_median<true>(node, axis, lists)) return false;
    } else if (lists.above.size() < lists.below.size()) {
      if (!move_median<false>(node, axis, lists)) return false;
    }
    for (std::size_t i = 0; i < lists.above.size(); ++i) store_.swap(lists.above[i], lists.below[i]);
    lists.moved += 2 * lists.above.size();
    if (node.size() / 2 <= leaf_) return true;  // nothing below is asked for its bounds
    fit_again(node.left(), lists.above.data(), lists.above.data() + lists.above.size());
    fit_again(node.right(), lists.below.data(), lists.below.data() + lists.below.size());
    return true;
  }

  // Brings the particle with the median key to `mid`, where particles above it (`up`), or else below it, have to be
  // passed as many times as one list of misplaced particles is longer than the other. Candidates are those on the
  // longer list, and those behind the old median on its other side, of which those up to `width` are known. The lists
  // are then those of the new median.
  template <bool up>
  bool move_median(const Node& node, int axis, Lists& lists) {
    std::vector<std::uint64_t>& here = up ? lists.above : lists.below;
    std::vector<std::uint64_t>& there = up ? lists.below : lists.above;
    const Node other = up ? node.right() : node.left();
    const std::size_t wanted = here.size() - there.size();
    const Key plane = nodes_[node.index].own[axis];
    if (!list_candidates<up>(other, axis, plane, wanted, here, lists)) return false;
    const auto nth = lists.keyed.begin() + static_cast<std::ptrdiff_t>(wanted - 1);
    std::nth_element(lists.keyed.begin(), nth, lists.keyed.end(),
                     [](const Keyed& a, const Keyed& b) { return up ? a.key < b.key : a.key > b.key; });
    const Keyed median = *nth;
    store_.swap(node.mid(), median.place);
    lists.moved += 2;
    read_own(node);

    here.clear();
    const auto is_in = [](const Node& part, std::uint64_t place) { return place >= part.begin && place < part.end; };
    for (const Keyed& one : lists.keyed) {
      if (is_in(other, one.place)) {
        if (up ? one.key < median.key : one.key > median.key) there.push_back(one.place);
      } else {
        if (up ? one.key > median.key : one.key < median.key) here.push_back(one.place);
      }
    }
    // The old median is now where the new one was.
    const bool old_is_misplaced = is_in(other, median.place) && plane != median.key;
    if (old_is_misplaced) there.push_back(median.place);
    // Of equal keys there may be more than were asked for. Partners are then particles that have the median key: there
    // are some on the other side.
    if (here.size() != there.size() && !add_equal<up>(node, axis, median.key, lists)) return false;
    std::sort(here.begin(), here.end());
    std::sort(there.begin(), there.end());
    if (!old_is_misplaced)
      fit_again(is_in(other, median.place) ? other : up ? node.left() : node.right(), &median.place, &median.place + 1);
    return true;
  }

  // `wanted` candidates or more, and all those `here`.
  template <bool up>
  bool list_candidates(const Node& other, int axis, Key plane, std::size_t wanted,
                       const std::vector<std::uint64_t>& here, Lists& lists) {
    using kernels::Relation;
    const Box& far = nodes_[other.index].box;
    const Key extent = up ? far.upper[axis] - plane : plane - far.lower[axis];
    // Twice the room that so many particles have, and more as long as there are too few.
    Key width = extent * static_cast<Key>(2 * wanted) / static_cast<Key>(other.size() + 1);
    for (int tries = 0;; width *= 4, ++tries) {
      const bool all = tries == 12 || !(width < extent);
      const Key edge = (up ? Key{1} : Key{-1}) * (all ? std::numeric_limits<Key>::infinity() : width) + plane;
      if (!list(other, axis, up ? Relation::not_greater : Relation::not_less, edge, lists, lists.others)) return false;
      lists.keyed.clear();
      for (const std::uint64_t place : lists.others) {
        const Key key = store_.key(place, axis);
        if (up ? key >= plane : key <= plane) lists.keyed.push_back({key, place});
      }
      std::size_t within = lists.keyed.size();
      for (const std::uint64_t place : here) {
        const Key key = store_.key(place, axis);
        within += (up ? key <= edge : key >= edge) ? 1 : 0;
        lists.keyed.push_back({key, place});
      }
      if (within >= wanted) return true;
      if (all) return false;
    }
  }

  template <bool up>
  bool add_equal(const Node& node, int axis, Key median, Lists& lists) {
    std::vector<std::uint64_t>& here = up ? lists.above : lists.below;
    std::vector<std::uint64_t>& there = up ? lists.below : lists.above;
    const bool more_here = here.size() > there.size();
    const std::vector<std::uint64_t>& longer = more_here ? here : there;
    std::vector<std::uint64_t>& shorter = more_here ? there : here;
    const bool on_the_right = more_here == up;
    const Node side = on_the_right ? node.right() : node.left();
    lists.most = static_cast<std::size_t>(side.size());
    list(side, axis, on_the_right ? kernels::Relation::not_greater : kernels::Relation::not_less, median, lists,
         lists.others);
    for (const std::uint64_t place : lists.others) {
      if (shorter.size() == longer.size()) break;
      if (store_.key(place, axis) == median) shorter.push_back(place);
    }
    return shorter.size() == longer.size();
  }

  // The places whose keys are `relation` to the pivot, in increasing order. False when there are too many.
  bool list(const Node& node, int axis, kernels::Relation relation, Key pivot, Lists& lists,
            std::vector<std::uint64_t>& places) const {
    places.clear();
    lists.runs.clear();
    switch (relation) {
      case kernels::Relation::greater:
        find_runs<kernels::Relation::greater>(node, axis, pivot, lists.runs);
        break;
      case kernels::Relation::not_less:
        find_runs<kernels::Relation::not_less>(node, axis, pivot, lists.runs);
        break;
      case kernels::Relation::less:
        find_runs<kernels::Relation::less>(node, axis, pivot, lists.runs);
        break;
      case kernels::Relation::not_greater:
        find_runs<kernels::Relation::not_greater>(node, axis, pivot, lists.runs);
        break;
    }
    Place found[kernels::exchange_block + kernels::list_slack];
    for (const kernels::PlaceRange& run : lists.runs) {
      if (places.size() > lists.most) return false;
      for (std::uint64_t begin = run.begin; begin < run.end; begin += kernels::exchange_block) {
        const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(kernels::exchange_block, run.end - begin));
        const std::size_t count = store_.list(begin, size, axis, relation, pivot, found);
        for (std::size_t i = 0; i < count; ++i) places.push_back(begin + found[i]);
      }
    }
    return true;
  }

  // Where they may be, and asks for that from memory.
  template <kernels::Relation relation>
  void find_runs(const Node& node, int axis, Key pivot, std::vector<kernels::PlaceRange>& runs) const {
    // A box holds what is asked for when the farther of its two sides does.
    constexpr bool up = relation == kernels::Relation::greater || relation == kernels::Relation::not_less;
    const Known& known = nodes_[node.index];
    if (!kernels::holds(relation, up ? known.box.upper[axis] : known.box.lower[axis], pivot)) return;
    if (is_run(node)) {
      store_.prefetch(node.begin, node.size());
      runs.push_back({node.begin, node.end});
      return;
    }
    find_runs<relation>(node.left(), axis, pivot, runs);
    if (kernels::holds(relation, known.own[axis], pivot)) runs.push_back({node.mid(), node.mid() + 1});
    find_runs<relation>(node.right(), axis, pivot, runs);
  }

  Store& store_;
  const std::uint64_t leaf_;
  const unsigned most_height_;
  std::uint64_t run_ = 0;  // subtrees of at most so many particles have bounds as a whole
  std::unique_ptr<Known[]> nodes_;
  tbb::enumerable_thread_specific<Lists> lists_;
};

}  // namespace insitu
