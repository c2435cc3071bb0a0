// From insitu_filter to a checked filter.
#pragma once

#include <memory>

#include "core/budget.h"
#include "geometry/filter/filter.h"
#include "insitu/insitu.h"

namespace insitu {

// `description` as the caller gave it, its terms in the caller's size. NULL for one without terms. Throws Error.
std::shared_ptr<const Filter> read_filter(Budget& budget, const insitu_filter& description);

}  // namespace insitu
