// SPDX-License-Identifier: MIT
// The one list of the images of a view, and the view at another size.
#pragma once

#include "datasets/dataset.h"

namespace glint {

enum class MapKind { kColor, kDepth, kNormal };
inline int channels_of(MapKind kind) { return kind == MapKind::kDepth ? 1 : 3; }

// Calls f(name, image, kind) for every map of a view (const or not), also for those that are empty;
// the glass mask is not among them.
template <class AnyView, class F>
void for_each_map(AnyView& view, F&& f) {
  f("rgb", view.rgb, MapKind::kColor);
  f("prior.normal", view.priors.normal, MapKind::kNormal);
  f("prior.depth", view.priors.depth, MapKind::kDepth);
  f("prior.albedo", view.priors.albedo, MapKind::kColor);
  f("prior.basecolor", view.priors.basecolor, MapKind::kColor);
  f("truth.depth", view.truth.depth, MapKind::kDepth);
  f("truth.normal", view.truth.normal, MapKind::kNormal);
  f("truth.albedo", view.truth.albedo, MapKind::kColor);
  f("truth.behind_depth", view.truth.behind_depth, MapKind::kDepth);
  f("truth.behind_normal", view.truth.behind_normal, MapKind::kNormal);
  f("truth.transmitted", view.truth.transmitted, MapKind::kColor);
  f("truth.reflected", view.truth.reflected, MapKind::kColor);
}

// Images, mask and camera at the size that `size` or `max_pixels` of the options ask for.
void fit_view(View& view, const LoadOptions& options);

}  // namespace glint
