#include "kernels/pkd_transparent.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/pkd_transparent.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

#include "kernels/pkd_single-inl.h"
#include "kernels/transparent_visitors.h"

HWY_BEFORE_NAMESPACE();
namespace insitu::kernels::HWY_NAMESPACE {

template <class Visitor>
void TraverseLayout(const PkdTree& tree, const Ray& ray, Visitor& visitor) {
  switch (layout_of(tree)) {
    case PkdLayout::placed_f32:
      return TraverseTree(tree, PlacedPositions<float>(tree), ray, visitor);
    case PkdLayout::placed_f64:
      return TraverseTree(tree, PlacedPositions<double>(tree), ray, visitor);
    case PkdLayout::indexed_f32:
      return TraverseTree(tree, IndexedPositions<float>(tree), ray, visitor);
    case PkdLayout::indexed_f64:
      return TraverseTree(tree, IndexedPositions<double>(tree), ray, visitor);
    case PkdLayout::general:
      return TraverseTree(tree, GeneralPositions(tree), ray, visitor);
  }
}

// What ends before the last entry of the list before is passed by: a sphere that is entered behind it does not.
void NearestEntriesOf(const PkdTree& tree, const Ray& ray, double scale, std::uint32_t geometry,
                      const ItemOpacity& opacity, NearestEntries& entries) {
  NearestEntriesVisitor visitor(ray, scale, geometry, opacity, entries);
  Ray search = ray;
  search.t_min = std::max(ray.t_min, entries.behind().t / scale * NearestEntriesVisitor::rounding_down);
  TraverseLayout(tree, search, visitor);
}

OpticalDepth OpticalDepthOf(const PkdTree& tree, const Ray& ray, const ItemOpacity& opacity, OpticalDepth depth) {
  TransmittanceVisitor visitor(ray, opacity, depth);
  TraverseLayout(tree, ray, visitor);
  return visitor.depth();
}

}  // namespace insitu::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace insitu::kernels {

HWY_EXPORT(NearestEntriesOf);
HWY_EXPORT(OpticalDepthOf);

void pkd_nearest_entries(const PkdTree& tree, const Ray& ray, double scale, std::uint32_t geometry,
                         const ItemOpacity& opacity, NearestEntries& entries) {
  HWY_DYNAMIC_DISPATCH(NearestEntriesOf)(tree, ray, scale, geometry, opacity, entries);
}

OpticalDepth pkd_optical_depth(const PkdTree& tree, const Ray& ray, const ItemOpacity& opacity, OpticalDepth depth) {
  return HWY_DYNAMIC_DISPATCH(OpticalDepthOf)(tree, ray, opacity, depth);
}

}  // namespace insitu::kernels
#endif
