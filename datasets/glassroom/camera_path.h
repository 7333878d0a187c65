// SPDX-License-Identifier: MIT
// The camera path: a continuous closed curve of two laps round the container, one lower, one
// higher, that always looks at it. Its radius keeps clear of walls and furniture; poses too close
// to something or whose view of the container is blocked are dropped, and the views are spread
// evenly over the rest.
#pragma once

#include <functional>
#include <vector>

#include "datasets/glassroom/path_tracer.h"
#include "datasets/glassroom/shapes.h"
#include "glint/core/rng.h"

namespace glint {

struct CameraPathOptions {
  ImageSize size{160, 90};
  int views = 64;
  double fov_x_deg = 85;
  double low_height = 1.2, high_height = 1.65;  // metres, of the two laps
  double min_radius = 1.4, max_radius = 2.3;    // metres from the container's axis
  double clearance = 0.35;                      // to anything, metres
  double min_visible = 0.7;  // share of probe points in the container that must be seen
  // Whether the floor is below a point (x, y), where that is not all of the room's box.
  std::function<bool(Vec2d)> above_floor = {};
};

// The room's inside and the container's box in the world (both axis-aligned).
// Errors (kEnvironment): less than a quarter of the path is usable.
std::vector<Camera> camera_path(
    const PathTracer& tracer,
    const Bounds& room,
    const Bounds& container,
    const CameraPathOptions& options,
    Rng& rng
);

// Share of a grid of points in the container that the camera sees: inside the image and not hidden
// by anything opaque outside the container.
double container_visibility(
    const PathTracer& tracer, const Bounds& container, const Camera& camera
);
// Distance from a point to the nearest surface over 26 directions.
double nearest_surface(const PathTracer& tracer, Vec3d point);

}  // namespace glint
