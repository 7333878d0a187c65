// SPDX-License-Identifier: MIT
#include "glint/train/glass_masks.h"

#include <fmt/format.h>

namespace glint {

const Image& glass_mask(const View& view) {
  return view.priors.has("glass") ? view.priors["glass"] : view.truth["glass"];
}

MaskCounts count_glass_masks(const std::vector<View>& views) {
  MaskCounts counts{views.size()};
  for (const View& view : views) {
    const bool prior = view.priors.has("glass");
    counts.prior += prior;
    counts.truth += !prior && view.truth.has("glass");
  }
  return counts;
}

std::string glass_mask_note(const MaskCounts& counts) {
  if (counts.none()) return "none";
  if (counts.prior == counts.views) return "the prior folder's";
  if (counts.truth == counts.views) return "the dataset's ground truth";
  return fmt::format(
      "the prior folder's for {}, the dataset's ground truth for {}, none for {} training views",
      counts.prior,
      counts.truth,
      counts.views - counts.prior - counts.truth
  );
}

}  // namespace glint
