#include "renderer/layers.h"

namespace insitu {

void LayeredRay::advance(const Scene& scene, std::vector<Layer>& layers) {
  kernels::NearestEntries next(behind_);
  if (opaque_.found())
    next.add({opaque_.t, opaque_.item, opaque_.geometry, true}, [](std::uint64_t, std::uint64_t) { return false; });
  scene.add_layers(ray_, next);
  for (const kernels::EnteredItem& entered : next) {
    Layer layer{{entered.t, entered.item, entered.geometry}, transmittance_, place_++};
    const double passed =
        entered.is_opaque
            ? 0.0
            : transmittance_ * (1.0 - double{scene.entries()[entered.geometry].colors.of(entered.item).a});
    if (passed >= least_transmittance) {
      layer.weight = transmittance_ - passed;
      transmittance_ = passed;
    } else {
      transmittance_ = 0.0;
    }
    layers.push_back(layer);
    if (transmittance_ == 0.0) break;
  }
  is_done_ = transmittance_ == 0.0 || !next.goes_on();
  if (next.size() > 0) behind_ = *(next.end() - 1);
}

}  // namespace insitu
