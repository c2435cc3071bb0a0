// Many sticks as one geometry. Where they stand is asked of a Source at every test, so that nothing is copied but the
// tree over their boxes. A Source is a class with
//   bool is_shown(std::uint64_t id) const;                        asked once, when the tree is built
//   bool stick(std::uint64_t id, kernels::Stick& out) const;      false: there is nothing to draw
//   std::uint64_t shown_item(std::uint64_t id, double along) const;   for the item channel; along: 0 to 1
//   std::uint64_t color_item(std::uint64_t id, double along) const;
//   bool prefer(std::uint64_t a, std::uint64_t b) const;  of two hit at exactly the same distance, the one to show,
//                                                         whatever the ids are
// with ids below 2^32.
#pragma once

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "geometry/geometry.h"
#include "geometry/sticks/box_tree_build.h"
#include "kernels/stick.h"

namespace insitu {

// A box that holds the stick, and some roundings of its numbers more.
inline ItemBox box_of(const kernels::Stick& stick) {
  ItemBox box{};
  for (int c = 0; c < 3; ++c) {
    const double largest = std::max({std::abs(stick.a[c]), std::abs(stick.b[c]), stick.radius});
    const double reach = stick.radius + 1e-14 * largest;
    box.lower[c] = std::min(stick.a[c], stick.b[c]) - reach;
    box.upper[c] = std::max(stick.a[c], stick.b[c]) + reach;
  }
  return box;
}

template <class Source>
class Sticks final : public Geometry {
 public:
  const Source& source() const { return source_; }
  std::uint64_t bytes() const { return store_.bytes(); }
  std::uint64_t drawn_count() const { return store_.tree().count; }
  const std::uint32_t* drawn_ids() const { return store_.ids(); }  // in no particular order

  // Of the ids below `end`. Call within the workers. Throws Error(over_budget).
  void build(Budget& budget, const Source& source, std::uint64_t end, const char* what) {
    source_ = source;
    // In parts, put together in their order.
    constexpr std::uint64_t part = 1 << 14;
    struct Part {
      std::vector<ItemBox> boxes;
      std::vector<std::uint32_t> ids;
    };
    std::vector<Part> parts((end + part - 1) / part);
    tbb::parallel_for(std::uint64_t{0}, std::uint64_t{parts.size()}, [&](std::uint64_t p) {
      kernels::Stick stick;
      for (std::uint64_t id = p * part; id < std::min(end, (p + 1) * part); ++id) {
        if (!source_.is_shown(id) || !source_.stick(id, stick)) continue;
        parts[p].boxes.push_back(box_of(stick));
        parts[p].ids.push_back(static_cast<std::uint32_t>(id));
      }
    });
    std::vector<ItemBox> boxes;
    std::vector<std::uint32_t> ids;
    for (Part& p : parts) {
      boxes.insert(boxes.end(), p.boxes.begin(), p.boxes.end());
      ids.insert(ids.end(), p.ids.begin(), p.ids.end());
      p = {};
    }
    store_.build(budget, boxes, ids, what);
  }
  // Forgets the source; the memory is kept for the next step.
  void release() {
    store_.clear();
    source_ = {};
  }

  void bounds(double lower[3], double upper[3]) const override {
    std::copy_n(store_.bounds().lower, 3, lower);
    std::copy_n(store_.bounds().upper, 3, upper);
  }

  void first_hits(const kernels::Ray* rays, kernels::Hit* hits, std::size_t count) const override {
    for (std::size_t i = 0; i < count; ++i) {
      const kernels::Ray& ray = rays[i];
      kernels::Hit& hit = hits[i];
      bool own = false;  // the hit is one of these sticks
      const auto limit = [&] { return std::min(ray.t_max, hit.t); };
      kernels::walk_box_tree(store_.tree(), ray, limit, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t place = begin; place < end; ++place) {
          const std::uint64_t id = store_.ids()[place];
          const double t = meet(ray, id);
          if (!(t <= limit()) || t == std::numeric_limits<double>::infinity()) continue;
          if (t == hit.t && !(own && source_.prefer(id, hit.item))) continue;
          hit = {t, id};
          own = true;
        }
        return false;
      });
    }
  }

  void any_hits(const kernels::Ray* rays, std::uint8_t* occluded, std::size_t count) const override {
    for (std::size_t i = 0; i < count; ++i) {
      if (occluded[i] != 0) continue;
      const kernels::Ray& ray = rays[i];
      kernels::walk_box_tree(
          store_.tree(), ray, [&] { return ray.t_max; },
          [&](std::uint64_t begin, std::uint64_t end) {
            for (std::uint64_t place = begin; place < end && occluded[i] == 0; ++place) {
              const double t = meet(ray, store_.ids()[place]);
              if (t <= ray.t_max && t != std::numeric_limits<double>::infinity()) occluded[i] = 1;
            }
            return occluded[i] != 0;
          });
    }
  }

  Surface surface(std::uint64_t id, const double point[3]) const override {
    kernels::Stick stick{};
    source_.stick(id, stick);
    Surface surface{};
    const double along = kernels::stick_normal(stick, point, surface.normal);
    surface.magnitude = stick.radius;
    for (int c = 0; c < 3; ++c)
      surface.magnitude = std::max({surface.magnitude, std::abs(stick.a[c]), std::abs(stick.b[c])});
    surface.item = source_.shown_item(id, along);
    surface.color_item = source_.color_item(id, along);
    return surface;
  }

 private:
  double meet(const kernels::Ray& ray, std::uint64_t id) const {
    kernels::Stick stick;
    if (id == ray.exclude || !source_.stick(id, stick)) return std::numeric_limits<double>::infinity();
    return kernels::stick_first_hit(ray.origin, ray.direction, stick, ray.t_min);
  }

  Source source_;
  BoxTreeStore store_;
};

// By where they are: alike for any order of the ids. 0 when they are the same.
int compare(const kernels::Stick& a, const kernels::Stick& b);

}  // namespace insitu
