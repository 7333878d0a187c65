// SPDX-License-Identifier: MIT
#include "metrics/mesh/cull.h"

#include <algorithm>
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
constexpr double kMostParts = 64;     // of an edge: a plain of kilometres must not fill the memory

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

int num_parts(const Corners& corners, double max_edge) {
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k)
    longest = std::max(longest, length(corners[(k + 1) % 3] - corners[k]));
  return static_cast<int>(std::min(kMostParts, std::ceil(longest / max_edge)));
}

// Rows of n + 1, n, ..., 1 vertices from the side ab to the corner c, and the faces between.
void append_split(const Corners& corners, int n, TriangleMesh& mesh) {
  auto row = static_cast<std::int32_t>(mesh.vertices.size());
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i + j <= n; ++i) {
      const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
      mesh.vertices.push_back(
          cast<float>((1 - u - v) * corners[0] + u * corners[1] + v * corners[2])
      );
    }
  for (int j = 0; j < n; ++j) {
    const std::int32_t next = row + n + 1 - j;
    for (int i = 0; i + j < n; ++i) {
      mesh.faces.push_back({row + i, row + i + 1, next + i});
      if (i + j + 1 < n) mesh.faces.push_back({row + i + 1, next + i + 1, next + i});
    }
    row = next;
  }
}

void check_length(double value, const char* name) {
  GLINT_CHECK(
      std::isfinite(value) && value >= 0,
      kUsage,
      "culling: {} is {}; expected metres, 0 or more",
      name,
      value
  );
}

// Parts of all faces, n^2 each, have to be as many as one can hold: before they are made.
void check_parts(const TriangleMesh& mesh, double max_edge_m) {
  constexpr double kMostFaces = 1e8;
  double faces = 0;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const double n = num_parts(corners_of(mesh, i), max_edge_m);
    faces += n * n;
  }
  GLINT_CHECK(
      faces <= kMostFaces,
      kUsage,
      "culling: with max_edge_m (--max-edge) {} the mesh would have {:.2g} faces, expected at most "
      "{:.0g}; use longer edges, or metres where the mesh is in a smaller unit",
      max_edge_m,
      faces,
      kMostFaces
  );
}

}  // namespace

TriangleMesh split_long_faces(const TriangleMesh& mesh, double max_edge_m) {
  check_parts(mesh, max_edge_m);
  TriangleMesh split{mesh.vertices, {}, {}};
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const Corners corners = corners_of(mesh, i);
    if (const int n = num_parts(corners, max_edge_m); n > 1)
      append_split(corners, n, split);
    else
      split.faces.push_back(mesh.faces[i]);
  }
  return split;
}

CulledMesh cull_unseen(
    const TriangleMesh& mesh, std::span<const Camera> cameras, double tolerance_m, double max_edge_m
) {
  check_length(tolerance_m, "tolerance_m");
  check_length(max_edge_m, "max_edge_m");
  const TriangleMesh split = max_edge_m > 0 ? split_long_faces(mesh, max_edge_m) : mesh;
  CulledMesh culled;
  if (!split.faces.empty())
    culled.mesh = select_faces(split, find_seen(split, cameras, tolerance_m));
  culled.recipe.num_cameras = cameras.size();
  culled.recipe.tolerance_m = tolerance_m, culled.recipe.max_edge_m = max_edge_m;
  culled.recipe.faces_before = mesh.faces.size();
  culled.recipe.faces_split = split.faces.size();
  culled.recipe.faces_after = culled.mesh.faces.size();
  culled.recipe.area_before_m2 = surface_area(mesh);
  culled.recipe.area_after_m2 = surface_area(culled.mesh);
  return culled;
}

}  // namespace glint
