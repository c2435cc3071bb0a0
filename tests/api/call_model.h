// What insitu.h says that each call returns, as a small model of a context's state. The texts are not part of it.
#pragma once

#include <cstdint>
#include <vector>

#include "insitu/insitu.h"

namespace insitu::testing {

struct ModelSet {
  bool alive = true;
  std::uint32_t order = INSITU_ORDER_INDEX;
  bool keeps = false;     // INSITU_PARTICLES_KEEP_PERMUTATION
  bool bound = false;     // updated in the open step, and not put back since
  bool built = false;     // and committed
  bool has_heat = false;  // the arrays have the attribute "heat"
  std::uint64_t count = 0;
  bool styled_by_heat = false;
  bool filtered_by_heat = false;
  int colormap = -1;  // index of an own map that the style refers to
};

struct ModelImage {
  bool alive = true;
  bool rendered = false;
};

class CallModel {
 public:
  bool in_step = false;
  bool committed = false;
  insitu_status sticky = INSITU_OK;
  std::vector<ModelSet> sets;
  std::vector<bool> views;
  std::vector<ModelImage> images;
  std::vector<bool> colormaps;

  // Every call goes through one of these two. `status` is what the call comes to when nothing stands in its way.
  insitu_status call(insitu_status status) {
    if (in_step && sticky != INSITU_OK) return sticky;
    return always(status);
  }
  // For calls that work after an error as well: destruction and statistics.
  insitu_status always(insitu_status status) {
    if (in_step && sticky == INSITU_OK) sticky = status;
    return status;
  }
  // True when a call will do what it says, as far as the step's first error is concerned.
  bool listens() const { return !in_step || sticky == INSITU_OK; }

  insitu_status needs_step() const { return in_step ? INSITU_OK : INSITU_ERROR_WRONG_STATE; }
  insitu_status needs_commit() const { return in_step && committed ? INSITU_OK : INSITU_ERROR_WRONG_STATE; }

  // What can be wrong with a commit: nothing, or any of these. With several sets, or several errors in one, it is not
  // said which comes first. A set that was not updated in this step takes no part.
  std::vector<insitu_status> commit_problems() const {
    if (!in_step) return {INSITU_ERROR_WRONG_STATE};
    std::vector<insitu_status> problems;
    for (const ModelSet& set : sets) {
      if (!set.alive || !set.bound) continue;
      if (set.colormap >= 0 && !colormaps[static_cast<std::size_t>(set.colormap)])
        problems.push_back(INSITU_ERROR_INVALID_HANDLE);
      if ((set.styled_by_heat || set.filtered_by_heat) && !set.has_heat)
        problems.push_back(INSITU_ERROR_INVALID_ARGUMENT);
    }
    return problems;
  }
  // The same for rendering and fitting, which need every set to be built.
  std::vector<insitu_status> scene_problems() const {
    if (needs_commit() != INSITU_OK) return {needs_commit()};
    std::vector<insitu_status> problems = commit_problems();
    for (const ModelSet& set : sets)
      if (set.alive && set.bound && !set.built) problems.push_back(INSITU_ERROR_WRONG_STATE);
    return problems;
  }
  void end_step() {
    in_step = committed = false;
    sticky = INSITU_OK;
    for (ModelSet& set : sets) set.bound = set.built = false;
  }
};

}  // namespace insitu::testing
