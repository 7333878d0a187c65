// SPDX-License-Identifier: MIT
// Where the maps of a view lie in folders whose format has no place for them (COLMAP, nerfstudio,
// Blender), under the names that trainers of the field look for:
//   masks/<view>.png           glass is white; ground truth
//   depths/<view>.png          16 bit, millimetres (or depth_scale of scene.json), 0: nothing;
//                              ground truth, first surface. Or .exr, .npy in metres
//   normals/<view>.png         prior, (n + 1) / 2, camera space, OpenCV axes
//   priors/<prior>/<view>.png  the other priors; depth 16 bit, relative
//   counted/<view>.png         masks of the pixels that count (white), of views where not all do;
//   in
//                              every format
// Other ground truth has no place there.
#pragma once

#include "glint/core/files.h"
#include "glint/scene/maps.h"

namespace glint {

// Below the folder; empty: no place.
inline fs::path side_prior_file(const MapRow& row, const std::string& view) {
  if (row.prior.empty()) return {};
  if (row.id == "normal") return fs::path("normals") / (view + ".png");
  return fs::path("priors") / row.prior / (view + ".png");
}

inline fs::path side_truth_file(const MapRow& row, const std::string& view) {
  if (row.id == "glass") return fs::path("masks") / (view + ".png");
  if (row.id == "depth") return fs::path("depths") / (view + ".png");
  return {};
}

inline fs::path counted_file(const std::string& view) {
  return fs::path("counted") / (view + ".png");
}

}  // namespace glint
