// SPDX-License-Identifier: MIT
#include "glint/train/neighbor_views.h"

#include <algorithm>
#include <cmath>

namespace glint {

namespace {

Vec3d axis_of(const Camera& camera) { return camera.rotation_cam_from_world.rows[2]; }

}  // namespace

std::vector<std::vector<std::size_t>> neighbor_views(
    const std::vector<View>& views, const NeighborConfig& config, double unit
) {
  const double min_cosine = std::cos(static_cast<double>(config.max_angle_deg) * M_PI / 180);
  const double nearest = static_cast<double>(config.min_distance) * unit;
  const double farthest = static_cast<double>(config.max_distance) * unit;
  std::vector<std::vector<std::size_t>> neighbors(views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Camera& camera = views[i].camera;
    std::vector<std::pair<double, std::size_t>> found;
    for (std::size_t j = 0; j < views.size(); ++j) {
      const double distance = length(views[j].camera.center() - camera.center());
      const bool near = distance > nearest && distance < farthest;
      if (j != i && near && dot(axis_of(camera), axis_of(views[j].camera)) > min_cosine)
        found.emplace_back(distance, j);
    }
    std::sort(found.begin(), found.end());
    const std::size_t count = std::min(found.size(), static_cast<std::size_t>(config.count));
    for (std::size_t k = 0; k < count; ++k) neighbors[i].push_back(found[k].second);
  }
  return neighbors;
}

}  // namespace glint
