// SPDX-License-Identifier: MIT
// Leaves out what no camera sees: a reconstruction is not asked for the back of a cupboard, and
// whatever it puts there is not held against it. A step of its own with a recipe that is written
// next to the result. Uses glint/scene/camera.h, the one thing that a mesh metric knows of scenes.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "glint/core/triangle_mesh.h"
#include "glint/scene/camera.h"

namespace glint {

// What was done; config_to_json() prints it.
struct CullRecipe {
  std::string rule =
      "a face stays when some camera has its centroid in front, inside the image, and no face of "
      "the same mesh on the straight line between more than the tolerance nearer";
  std::size_t num_cameras = 0;
  double tolerance_m = 0, max_edge_m = 0;
  std::size_t faces_before = 0, faces_split = 0, faces_after = 0;
  double area_before_m2 = 0, area_after_m2 = 0;
  template <class V>
  void visit(V&& v) {
    v("rule", rule, "in words");
    v("num_cameras", num_cameras, "training cameras");
    v("tolerance_m", tolerance_m, "metres");
    v("max_edge_m", max_edge_m, "metres; faces with longer edges were split before");
    v("faces_before", faces_before, "of the cleaned mesh");
    v("faces_split", faces_split, "once long ones were split");
    v("faces_after", faces_after, "that count");
    v("area_before_m2", area_before_m2, "square metres");
    v("area_after_m2", area_after_m2, "square metres");
  }
};

struct CulledMesh {
  TriangleMesh mesh;  // may be without faces
  CullRecipe recipe;
};

// The mesh is clean (clean_mesh) and hides itself: call it for either side alone. Glass hides what
// is behind it as any face does. Faces with an edge above `max_edge_m` (0: none) are split first,
// so that a wall of two triangles is not kept or lost whole. Errors (kUsage): numbers that are
// negative or not finite.
CulledMesh cull_unseen(
    const TriangleMesh& mesh, std::span<const Camera> cameras, double tolerance_m, double max_edge_m
);

// Each face with an edge above `max_edge_m` in n x n equal ones, n the least that shortens them
// enough, 64 at most. Their vertices are their own; colours are dropped.
TriangleMesh split_long_faces(const TriangleMesh& mesh, double max_edge_m);

}  // namespace glint
