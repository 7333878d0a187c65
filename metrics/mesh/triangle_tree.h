// SPDX-License-Identifier: MIT
// A mesh as a search structure (Embree): the nearest face of a point, the first on a ray.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "glint/core/triangle_mesh.h"

namespace glint {

// Where a point's nearest neighbour on a surface is.
struct Nearest {
  double distance = std::numeric_limits<double>::infinity();  // metres
  std::int32_t id = -1;                                       // of a face or point; -1: none
};

// Where a ray meets a surface first.
struct RayHit {
  float t = std::numeric_limits<float>::infinity();  // in lengths of the ray's direction
  std::int32_t face = -1;                            // -1: nowhere
};

// All queries may run in parallel and do not depend on the number of threads.
class TriangleTree {
 public:
  // The mesh has faces, all with an area, and outlives the tree. Errors (kEnvironment): Embree.
  explicit TriangleTree(const TriangleMesh& mesh);
  ~TriangleTree();
  TriangleTree(const TriangleTree&) = delete;
  TriangleTree& operator=(const TriangleTree&) = delete;

  // The nearest face, the first of several as near; the distance is computed in double. Faces at or
  // beyond `max_distance` are none: then it is the distance. `guess`: a face that may be near, or
  // -1; makes it faster, nothing else.
  Nearest nearest(
      Vec3f point,
      double max_distance = std::numeric_limits<double>::infinity(),
      std::int32_t guess = -1
  ) const;

  // Whether a face is met from `origin` along the unit vector `direction` before `length` metres.
  bool is_blocked(Vec3f origin, Vec3f direction, float length) const;

  // The first face met along origin + t direction, t > 0, from either side.
  RayHit first_hit(Vec3f origin, Vec3f direction) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
