// SPDX-License-Identifier: MIT
#include "metrics/mesh/cull.h"

#include <cmath>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "metrics/mesh/clean.h"
#include "metrics/mesh/samples.h"
#include "metrics/mesh/triangle.h"
#include "metrics/mesh/triangle_tree.h"

namespace glint {
namespace {

constexpr std::size_t kBlock = 1024;  // faces

bool is_inside_image(const Camera& camera, Vec3d point) {
  const Vec3d in_cam = camera.to_cam(point);
  if (!(in_cam.z > 0)) return false;
  const Vec2d pixel = camera.project(in_cam);
  return pixel.x >= 0 && pixel.y >= 0 && pixel.x < camera.width && pixel.y < camera.height;
}

bool is_hidden(const TriangleTree& tree, Vec3d eye, Vec3d point, double tolerance) {
  const double distance = length(point - eye), free = distance - tolerance;
  if (!(free > 0)) return false;
  const Vec3d direction = 1 / distance * (point - eye);
  return tree.is_blocked(cast<float>(eye), cast<float>(direction), static_cast<float>(free));
}

// Asks the cameras from `first` on, around; the first that sees the point, or -1.
int find_witness(
    const TriangleTree& tree,
    std::span<const Camera> cameras,
    Vec3d point,
    double tolerance,
    int first
) {
  const int count = static_cast<int>(cameras.size());
  for (int i = 0; i < count; ++i) {
    const int id = (first + i) % count;
    const Camera& camera = cameras[static_cast<std::size_t>(id)];
    if (is_inside_image(camera, point) && !is_hidden(tree, camera.center(), point, tolerance))
      return id;
  }
  return -1;
}

Vec3d centroid(const Corners& corners) { return 1.0 / 3 * (corners[0] + corners[1] + corners[2]); }

// Neighbouring faces are often seen by the same camera: each block asks its last witness first,
// which decides how fast, not what, is found.
std::vector<std::uint8_t> find_seen(
    const TriangleMesh& mesh, std::span<const Camera> cameras, double tolerance
) {
  std::vector<std::uint8_t> seen(mesh.faces.size());
  const TriangleTree tree(mesh);
  parallel_for_blocks(mesh.faces.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    int last = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const int witness =
          find_witness(tree, cameras, centroid(corners_of(mesh, i)), tolerance, last);
      seen[i] = witness >= 0;
      if (witness >= 0) last = witness;
    }
  });
  return seen;
}

}  // namespace

CulledMesh cull_unseen(
    const TriangleMesh& mesh, std::span<const Camera> cameras, double tolerance_m
) {
  GLINT_CHECK(
      std::isfinite(tolerance_m) && tolerance_m >= 0,
      kUsage,
      "tolerance of culling: {}; expected metres, 0 or more",
      tolerance_m
  );
  CulledMesh culled;
  if (!mesh.faces.empty()) culled.mesh = select_faces(mesh, find_seen(mesh, cameras, tolerance_m));
  culled.recipe.num_cameras = cameras.size();
  culled.recipe.tolerance_m = tolerance_m;
  culled.recipe.faces_before = mesh.faces.size();
  culled.recipe.faces_after = culled.mesh.faces.size();
  culled.recipe.area_before_m2 = surface_area(mesh);
  culled.recipe.area_after_m2 = surface_area(culled.mesh);
  return culled;
}

}  // namespace glint
