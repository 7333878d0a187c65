// SPDX-License-Identifier: MIT
#include "reports/run/bench/voxel_choice.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/median.h"

namespace glint {

namespace {

constexpr std::size_t kMostPoints = 2000;                // looked at in each view
constexpr double kMostVoxels = 2000, kLeastVoxels = 50;  // along the diagonal

bool sees(const Camera& camera, Vec3d in_cam) {
  if (in_cam.z <= 0) return false;
  const Vec2d at = camera.project(in_cam);
  return at.x >= 0 && at.y >= 0 && at.x < camera.width && at.y < camera.height;
}

// Of the points that the view sees; empty: none.
std::vector<double> depths_of(const Scene& scene, const Camera& camera) {
  const auto& points = scene.points.positions;
  const std::size_t step = std::max<std::size_t>(1, points.size() / kMostPoints);
  std::vector<double> depths;
  for (std::size_t i = 0; i < points.size(); i += step) {
    const Vec3d in_cam = camera.to_cam(cast<double>(points[i]));
    if (sees(camera, in_cam)) depths.push_back(in_cam.z);
  }
  return depths;
}

double two_digits(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return std::round(value / unit) * unit;
}

}  // namespace

VoxelChoice choose_voxel(const Scene& scene) {
  GLINT_CHECK(!scene.train.empty(), kBadReference, "{}: no training view", scene.name);
  const double diagonal = length(cast<double>(scene.bounds_max - scene.bounds_min));
  std::vector<double> depths, pixels;
  for (const View& view : scene.train) {
    const std::vector<double> seen = depths_of(scene, view.camera);
    depths.push_back(seen.empty() ? diagonal / 2 : upper_median(seen));
    pixels.push_back(depths.back() / view.camera.fx);
  }
  VoxelChoice choice;
  const double pixel = upper_median(pixels);
  choice.voxel = two_digits(std::clamp(pixel, diagonal / kMostVoxels, diagonal / kLeastVoxels));
  choice.why = fmt::format(
      "voxel {:.3g} m: a pixel of {}x{} at the usual depth of {:.2g} m is {:.2g} m wide",
      choice.voxel,
      scene.train.front().camera.width,
      scene.train.front().camera.height,
      upper_median(depths),
      pixel
  );
  return choice;
}

}  // namespace glint
