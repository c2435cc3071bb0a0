// The filter of a step: what --filter asks for, with the attributes that the frame has.
#pragma once

#include "insitu/insitu.h"

#include <deque>
#include <vector>

#include "frame.h"
#include "options.h"

namespace replay {

class FrameFilter {
 public:
  // Throws UsageError with the names that would be valid.
  FrameFilter(const Frame& frame, const Options& options);
  // Without terms where nothing was asked for.
  insitu_filter filter() const;

 private:
  // Places in memory that the terms point to stay.
  std::deque<FilterCondition> conditions_;
  std::deque<insitu_array> sets_;
  std::vector<insitu_filter_term> terms_;
};

}  // namespace replay
