// SPDX-License-Identifier: MIT
// What is known of the surfaces that views see, for priors to be compared with: true depth, or
// sparse points with the planes through neighbouring ones.
#pragma once

#include <optional>
#include <vector>

#include "datasets/scene_index.h"

namespace glint {

// A place of a map whose surface is known, in the axes of the camera that sees it.
struct KnownPixel {
  int x = 0, y = 0;
  double depth = 0;             // planar
  std::optional<Vec3d> normal;  // unit, facing the camera
};

// Points on surfaces with the normals of the planes through the points around them.
class KnownPoints {
 public:
  // Of a large file evenly many. No points where it is missing, damaged or nearly empty.
  explicit KnownPoints(const fs::path& file);

  bool empty() const { return points_.empty(); }
  // Those that the camera sees: of the points of a small part of the image those near the nearest.
  std::vector<KnownPixel> seen_by(const Camera& camera) const;

 private:
  void find_normals();

  std::vector<Vec3f> points_;
  std::vector<std::optional<Vec3d>> normals_;  // world, either side; nothing: no plane there
};

// As stated with the camera, else as stored.
ImageSize picture_size(const ViewSource& view);

// Of a grid of about 64 pixels a side. `depth`: true, planar, 0: nothing.
std::vector<KnownPixel> known_pixels(const Camera& camera, ImageView depth);

}  // namespace glint
