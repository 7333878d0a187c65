// SPDX-License-Identifier: MIT
// Planes in points with normals, and the rectangles that the points fill of them.
#pragma once

#include <vector>

#include "glint/train/mirror_plane.h"

namespace glint {

// As somebody saw it: how far away it is may be wrong, the direction is not.
struct SurfacePoint {
  Vec3d position, normal, eye;  // world, metres; normal: unit
};

struct PlaneFit {
  double tolerance = 0.1;   // metres from its plane
  double min_cosine = 0.9;  // between normals
  double min_share = 0.03;  // of all points, for a plane to be one
  int max_planes = 16, tries = 200;
};

struct PlaneOfPoints {
  MirrorPlane plane;
  std::vector<SurfacePoint> points;
};

// Those that lie on it, and so.
std::vector<SurfacePoint> points_on(
    const MirrorPlane& plane, const std::vector<SurfacePoint>& points, const PlaneFit& settings
);
// Whether a plane's middle lies on the other's rectangle, and so.
bool lies_on(const MirrorPlane& plane, const MirrorPlane& other, const PlaneFit& settings);
// The planes of most points first, each without the points of those before it: mean normal, median
// distance, fitted rectangle.
std::vector<PlaneOfPoints> fit_planes(std::vector<SurfacePoint> points, const PlaneFit& settings);
// The smallest rectangle in the plane about where its points were seen; sides and centre are new.
void fit_rectangle(PlaneOfPoints& fitted);

}  // namespace glint
