// SPDX-License-Identifier: MIT
#include "glint/train/glass_masks.h"

#include <fmt/format.h>

#include "glint/train/transparency_kernels.h"

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

std::optional<double> dark_share_of_glass(const std::vector<View>& views, float low_albedo) {
  std::size_t glass = 0, dark = 0;
  for (const View& view : views) {
    const Image &mask = glass_mask(view), &albedo = view.priors["albedo"];
    if (mask.empty() || albedo.empty()) continue;
    for (int y = 0; y < mask.height(); ++y)
      for (int x = 0; x < mask.width(); ++x) {
        if (!(mask.at(x, y) > 0.5f) || (!view.counted.empty() && view.counted.at(x, y) == 0))
          continue;
        ++glass;
        dark += LabelMaps::mean_rgb(albedo.view(), x, y) < low_albedo;
      }
  }
  if (glass == 0) return std::nullopt;
  return static_cast<double>(dark) / static_cast<double>(glass);
}

}  // namespace glint
