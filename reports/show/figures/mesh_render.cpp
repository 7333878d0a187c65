// SPDX-License-Identifier: MIT
#include "reports/show/figures/mesh_render.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "glint/core/parallel.h"
#include "glint/drawing/color_maps.h"
#include "glint/drawing/picture_grid.h"
#include "metrics/mesh/mesh_scores.h"
#include "metrics/mesh/triangle_tree.h"

namespace glint {

namespace {

constexpr float kAmbient = 0.2f, kHeadlight = 0.75f;  // of a white surface, as displayed
// Culling splits long faces, whose pieces lie where the face did up to rounding: of the depth.
constexpr float kSameDepth = 1e-3f;

Vec3d center_of(const Camera& camera, int x, int y) {
  return camera.ray_in_world(x + 0.5, y + 0.5);
}

bool is_scored(const MeshRender& whole, const MeshRender& scored, int x, int y) {
  const float depth = whole.depth.at(x, y);
  return depth > 0 && std::abs(scored.depth.at(x, y) - depth) <= kSameDepth * depth;
}

template <class F>
void for_each_pixel(ImageSize size, F&& body) {
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) body(x, y);
}

}  // namespace

MeshRender render_mesh(const TriangleMesh& mesh, const Camera& camera) {
  MeshRender render{Image(camera.width, camera.height, 1), Image(camera.width, camera.height, 1)};
  if (mesh.faces.empty()) return render;
  const TriangleTree tree(mesh);
  const std::vector<Vec3f> normals = face_normals(mesh);
  const Vec3f eye = cast<float>(camera.center());
  parallel_for(static_cast<std::size_t>(camera.height), 1, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < camera.width; ++x) {
      const Vec3f ray = cast<float>(center_of(camera, x, y));
      const RayHit hit = tree.first_hit(eye, ray);
      if (hit.face < 0) continue;
      const float cosine = dot(normals[static_cast<std::size_t>(hit.face)], ray) / length(ray);
      render.depth.at(x, y) = hit.t;
      render.cosine.at(x, y) = std::min(std::abs(cosine), 1.0f);
    }
  });
  return render;
}

Image shaded_picture(const MeshRender& render) {
  Image picture(render.depth.width(), render.depth.height(), 3, kNothingGrey);
  for_each_pixel(picture.size(), [&](int x, int y) {
    if (render.depth.at(x, y) > 0)
      std::fill_n(picture.pixel(x, y), 3, kAmbient + kHeadlight * render.cosine.at(x, y));
  });
  return picture;
}

Image distance_map(
    const MeshRender& whole,
    const MeshRender& scored,
    const TriangleMesh& truth,
    const Camera& camera
) {
  Image map(camera.width, camera.height, 1, std::numeric_limits<float>::quiet_NaN());
  SurfacePoints seen;
  std::vector<float*> targets;
  for_each_pixel(map.size(), [&](int x, int y) {
    const double depth = static_cast<double>(whole.depth.at(x, y));
    if (depth > 0) map.at(x, y) = kNotScored;
    if (!is_scored(whole, scored, x, y)) return;
    seen.positions.push_back(cast<float>(camera.center() + depth * center_of(camera, x, y)));
    targets.push_back(&map.at(x, y));
  });
  if (targets.empty()) return map;
  const DirectedDistances measured = distances_to(seen, truth);
  for (std::size_t i = 0; i < targets.size(); ++i)
    *targets[i] = static_cast<float>(measured.distances[i]);
  return map;
}

float mesh_error_high() { return static_cast<float>(default_thresholds_m().back()); }

Image distance_picture(const Image& distances) {
  Image picture = colorize_scalar(distances, 0, mesh_error_high(), ScalarColors::kMagma);
  for_each_pixel(picture.size(), [&](int x, int y) {
    if (distances.at(x, y) < 0) std::copy_n(hatch_color(x, y).data(), 3, picture.pixel(x, y));
  });
  return picture;
}

}  // namespace glint
