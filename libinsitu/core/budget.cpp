#include "core/budget.h"

#include <algorithm>
#include <string>

#include "core/error.h"

namespace insitu {

void Budget::take(std::uint64_t bytes, const char* what) {
  if (cap_ != 0 && (bytes > cap_ || owned_ > cap_ - bytes))
    throw Error(INSITU_ERROR_OVER_BUDGET, std::string(what) + " needs " + std::to_string(bytes) + " bytes; " +
                                              std::to_string(owned_) + " of the allowed " + std::to_string(cap_) +
                                              " bytes (max_extra_bytes) are in use");
  owned_ += bytes;
  peak_ = std::max(peak_, owned_);
}

}  // namespace insitu
