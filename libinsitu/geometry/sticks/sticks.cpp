#include "geometry/sticks/sticks.h"

namespace insitu {

int compare(const kernels::Stick& a, const kernels::Stick& b) {
  const double x[7] = {a.a[0], a.a[1], a.a[2], a.b[0], a.b[1], a.b[2], a.radius};
  const double y[7] = {b.a[0], b.a[1], b.a[2], b.b[0], b.b[1], b.b[2], b.radius};
  for (int i = 0; i < 7; ++i)
    if (x[i] != y[i]) return x[i] < y[i] ? -1 : 1;
  return 0;
}

}  // namespace insitu
