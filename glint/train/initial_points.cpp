// SPDX-License-Identifier: MIT
#include "glint/train/initial_points.h"

#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/core/rng.h"

namespace glint {

namespace {

bool sees(const Camera& camera, Vec3f point) { return camera.to_cam(cast<double>(point)).z > 0; }

// Points that no camera can see give surfels that no gradient reaches.
void check_in_front(const Scene& scene) {
  const auto& points = scene.points.positions;
  const bool any = std::any_of(points.begin(), points.end(), [&](Vec3f point) {
    return std::any_of(scene.train.begin(), scene.train.end(), [&](const View& view) {
      return sees(view.camera, point);
    });
  });
  GLINT_CHECK(
      any,
      kBadReference,
      "{}: none of {} points lies in front of any of {} training cameras; poses and points are in "
      "different coordinates or the cameras look along -z; `glint-bench dataset check` says more",
      scene.name,
      points.size(),
      scene.train.size()
  );
}

}  // namespace

PointCloud initial_points(const Scene& scene, std::size_t count, std::uint64_t seed) {
  if (!scene.points.positions.empty()) {
    check_in_front(scene);
    return scene.points;
  }
  Rng rng(seed, hash_name("initial points"));
  PointCloud points;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3f p, color;
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = rng.uniform(scene.bounds_min[axis], scene.bounds_max[axis]);
      color[axis] = rng.uniform();
    }
    points.positions.push_back(p);
    points.colors.push_back(color);
  }
  return points;
}

void warn_without_points(
    const Scene& scene, const std::string& method, std::vector<std::string>& warnings
) {
  if (scene.points.positions.empty())
    warnings.push_back(
        fmt::format("{}: {} has no points; starts from random ones", method, scene.name)
    );
}

int ReflectionGrid::cells_for(ImageSize size) const {
  const double wanted = kPointsPerPixel * static_cast<double>(size.num_pixels());
  const double along_axis = std::cbrt(wanted / std::max(points_per_cell, 1));
  return std::clamp(static_cast<int>(std::lround(along_axis)), 1, std::max(cells, 1));
}

float ReflectionGrid::coarseness(ImageSize size) const {
  return static_cast<float>(cells) / static_cast<float>(cells_for(size));
}

PointCloud ReflectionGrid::points(const Scene& scene, std::uint64_t seed) const {
  Rng rng(seed, hash_name("reflection points"));
  const int n = cells_for(scene.train.front().camera.size());
  const Vec3f cell = (1.0f / static_cast<float>(n)) * (scene.bounds_max - scene.bounds_min);
  PointCloud points;
  for (int index = 0; index < n * n * n; ++index) {
    const Vec3f corner{
        static_cast<float>(index % n),
        static_cast<float>(index / n % n),
        static_cast<float>(index / (n * n))};
    for (int i = 0; i < points_per_cell; ++i) {
      const Vec3f place = corner + Vec3f{rng.uniform(), rng.uniform(), rng.uniform()};
      points.positions.push_back(scene.bounds_min + hadamard(place, cell));
      const Vec3f color{rng.uniform(), rng.uniform(), rng.uniform()};
      points.colors.push_back(brightness * color);
    }
  }
  return points;
}

}  // namespace glint
