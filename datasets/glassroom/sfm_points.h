// SPDX-License-Identifier: MIT
// Simulated structure-from-motion points: on textured opaque surfaces that at least three training
// views see, with the error of triangulation; fewer behind glass, none on it nor on mirrors, and
// none of what is seen in those.
#pragma once

#include <cstdint>
#include <vector>

#include "datasets/glassroom/path_tracer.h"
#include "glint/core/config.h"
#include "glint/scene/surfels.h"

namespace glint {

struct SfmModel {
  int num_points = 6000;
  int min_views = 3;
  float behind_glass_rate = 0.25f;  // share of candidates kept whose ray passed glass
  float full_contrast = 0.08f;      // albedo contrast above which a candidate is always kept
  float plain_rate = 0.04f;         // kept share of candidates without contrast
  float sigma_pixels = 0.5f;        // reprojection error, pixels of an image 960 wide

  template <class V>
  void visit(V&& v) {
    v("num_points", num_points, "points asked for");
    v("min_views", min_views, "training views that must see a point");
    v("behind_glass_rate", behind_glass_rate, "kept share of candidates seen through glass");
    v("full_contrast", full_contrast, "albedo contrast above which candidates are always kept");
    v("plain_rate", plain_rate, "kept share of candidates without contrast");
    v("sigma_pixels", sigma_pixels, "reprojection error in pixels of an image 960 wide");
  }
};

struct SfmPoint {
  Vec3f position{};       // with error
  Vec3f true_position{};  // on a surface
  int view = 0;           // training view (index into `cameras`) and pixel that give its colour
  int x = 0, y = 0;
};

// Candidates are random pixels of random cameras. May return fewer than asked for.
std::vector<SfmPoint> sfm_points(
    const PathTracer& tracer,
    const std::vector<Camera>& cameras,
    const SfmModel& model,
    std::uint64_t seed
);

}  // namespace glint
