// SPDX-License-Identifier: MIT
#include "datasets/glassroom/sfm_points.h"

#include <algorithm>
#include <cmath>

#include "glint/core/parallel.h"
#include "glint/core/rng.h"

namespace glint {

namespace {

constexpr int kTriesPerPoint = 12;
constexpr double kReferenceWidth = 960;

struct Sighting {
  int count = 0;
  double baseline = 0;  // largest distance between two cameras that see the point
};

float largest_difference(Vec3f a, Vec3f b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

class PointFinder {
 public:
  PointFinder(const PathTracer& tracer, const std::vector<Camera>& cameras, const SfmModel& model)
      : tracer_(tracer), cameras_(cameras), model_(model) {}

  // A point from one random pixel, or nothing.
  bool find(Rng& rng, SfmPoint& point) const {
    point.view = static_cast<int>(rng.below(static_cast<std::uint32_t>(cameras_.size())));
    const Camera& camera = cameras_[static_cast<std::size_t>(point.view)];
    point.x = static_cast<int>(rng.below(static_cast<std::uint32_t>(camera.width)));
    point.y = static_cast<int>(rng.below(static_cast<std::uint32_t>(camera.height)));
    const auto hit = shoot(camera, point.x + 0.5, point.y + 0.5, true);
    if (!hit.hit || hit.mirror || rng.uniform() > keep_rate(camera, point, hit)) return false;
    const Sighting sighting = sightings(hit.position, hit.normal);
    if (sighting.count < model_.min_views) return false;
    point.true_position = hit.position;
    point.position =
        hit.position + triangulation_error(camera, hit.position, sighting.baseline, rng);
    return true;
  }

 private:
  PathTracer::FirstHit shoot(const Camera& camera, double x, double y, bool skip_glass) const {
    return tracer_.first_hit(
        cast<float>(camera.center()), cast<float>(camera.ray_in_world(x, y)), skip_glass
    );
  }

  float keep_rate(const Camera& camera, const SfmPoint& point, const PathTracer::FirstHit& hit)
      const {
    float contrast = 0;
    for (const auto [dx, dy] : {Vec2d{-0.5, 0.5}, {1.5, 0.5}, {0.5, -0.5}, {0.5, 1.5}}) {
      const auto beside = shoot(camera, point.x + dx, point.y + dy, true);
      if (beside.hit) contrast = std::max(contrast, largest_difference(beside.albedo, hit.albedo));
    }
    const float textured =
        std::max(model_.plain_rate, std::min(1.0f, contrast / model_.full_contrast));
    const bool through_glass = shoot(camera, point.x + 0.5, point.y + 0.5, false).glass;
    return textured * (through_glass ? model_.behind_glass_rate : 1.0f);
  }

  Sighting sightings(Vec3f position, Vec3f normal) const {
    Sighting sighting;
    std::vector<Vec3d> eyes;
    const Vec3f off_surface = position + 1e-3f * normal;
    for (const Camera& camera : cameras_) {
      const Vec3d in_cam = camera.to_cam(cast<double>(position));
      if (in_cam.z <= 0.1) continue;
      const Vec2d pixel = camera.project(in_cam);
      if (pixel.x < 0 || pixel.y < 0 || pixel.x >= camera.width || pixel.y >= camera.height)
        continue;
      if (tracer_.occluded(off_surface, cast<float>(camera.center()))) continue;
      eyes.push_back(camera.center());
      for (const Vec3d& other : eyes)
        sighting.baseline = std::max(sighting.baseline, length(other - eyes.back()));
    }
    sighting.count = static_cast<int>(eyes.size());
    return sighting;
  }

  // A reprojection error of sigma pixels moves the point by sigma z / f across the ray and, by the
  // intersection angle, z / baseline times as far along it.
  Vec3f triangulation_error(const Camera& camera, Vec3f position, double baseline, Rng& rng) const {
    const Vec3d in_cam = camera.to_cam(cast<double>(position));
    const double focal = camera.fx * kReferenceWidth / camera.width;
    const double across = static_cast<double>(model_.sigma_pixels) * in_cam.z / focal;
    const double along = across * std::clamp(in_cam.z / std::max(baseline, 1e-3), 1.0, 10.0);
    const Vec3d ray = normalize(in_cam);
    Vec3d error{
        across * static_cast<double>(rng.normal()),
        across * static_cast<double>(rng.normal()),
        across * static_cast<double>(rng.normal())};
    error += (along * static_cast<double>(rng.normal()) - dot(error, ray)) * ray;
    return cast<float>(transpose_times(camera.rotation_cam_from_world, error));
  }

  const PathTracer& tracer_;
  const std::vector<Camera>& cameras_;
  const SfmModel& model_;
};

}  // namespace

std::vector<SfmPoint> sfm_points(
    const PathTracer& tracer,
    const std::vector<Camera>& cameras,
    const SfmModel& model,
    std::uint64_t seed
) {
  if (cameras.empty()) return {};
  const PointFinder finder(tracer, cameras, model);
  const auto wanted = static_cast<std::size_t>(model.num_points);
  std::vector<SfmPoint> slots(wanted);
  std::vector<char> found(wanted, 0);
  // Each slot has its own random stream: the same points for any number of threads.
  parallel_for(wanted, 16, [&](std::size_t i) {
    Rng rng(seed, i);
    for (int attempt = 0; attempt < kTriesPerPoint && !found[i]; ++attempt)
      found[i] = finder.find(rng, slots[i]);
  });
  std::vector<SfmPoint> points;
  for (std::size_t i = 0; i < wanted; ++i)
    if (found[i]) points.push_back(slots[i]);
  return points;
}

}  // namespace glint
