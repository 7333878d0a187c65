// SPDX-License-Identifier: MIT
// All maps of a view, and the view at another size.
#pragma once

#include "datasets/dataset.h"

namespace glint {

// Calls f(name, map, row) for the image, its mask and every map of the table (of views that are not
// const also for those that are empty), under the names that packed scenes and messages use: "rgb",
// "prior.depth", "truth.glass".
template <class AnyView, class F>
void for_each_map(AnyView& view, F&& f) {
  f(std::string("rgb"), view.rgb, MapId("rgb").row());
  f(std::string("counted"), view.counted, kCountedRow);
  for (const MapRow& row : maps()) f(fmt::format("prior.{}", row.id), view.priors[row], row);
  for (const MapRow& row : maps()) f(fmt::format("truth.{}", row.id), view.truth[row], row);
}

// Images and camera at the size that `size` or `max_pixels` of the options ask for.
void fit_view(View& view, const LoadOptions& options);

}  // namespace glint
