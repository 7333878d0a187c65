// SPDX-License-Identifier: MIT
// Random surfels and cameras for tests of rasterize() and trace().
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "glint/core/rng.h"
#include "glint/render/rasterize.h"

namespace glint::test {

// Owned arrays behind a RasterInput.
struct SurfelArrays {
  int channels = 3;
  FloatArray means, scales, rotations, opacities, features;

  std::size_t count() const { return opacities.size(); }
  RasterInput view() const {
    RasterInput input;
    input.count = count();
    input.channels = channels;
    input.means = means;
    input.scales = scales;
    input.rotations = rotations;
    input.opacities = opacities;
    input.features = features;
    return input;
  }
  // `features`: as many values as channels.
  void add(Vec3d mean, Vec2d scale, Vec4<double> q, double opacity, std::vector<float> feature) {
    for (const double value : {mean.x, mean.y, mean.z}) means.push_back(static_cast<float>(value));
    for (const double value : {scale.x, scale.y}) scales.push_back(static_cast<float>(value));
    for (const double value : {q.w, q.x, q.y, q.z}) rotations.push_back(static_cast<float>(value));
    opacities.push_back(static_cast<float>(opacity));
    features.insert(features.end(), feature.begin(), feature.end());
  }
};

inline double uniform(Rng& rng, double low, double high) {
  return low + (high - low) * static_cast<double>(rng.uniform());
}
inline double log_uniform(Rng& rng, double low, double high) {
  return std::exp(uniform(rng, std::log(low), std::log(high)));
}
inline Vec3d random_direction(Rng& rng) {
  const double z = uniform(rng, -1, 1), azimuth = uniform(rng, 0, 2 * std::numbers::pi);
  const double radius = std::sqrt(1 - z * z);
  return {radius * std::cos(azimuth), radius * std::sin(azimuth), z};
}
// Uniform over rotations [Shoemake 1992].
inline Vec4<double> random_unit_quaternion(Rng& rng) {
  const double share = uniform(rng, 0, 1);
  const double a = uniform(rng, 0, 2 * std::numbers::pi), b = uniform(rng, 0, 2 * std::numbers::pi);
  const double s = std::sqrt(1 - share), t = std::sqrt(share);
  return {t * std::cos(b), s * std::sin(a), s * std::cos(a), t * std::sin(b)};
}

// A view from a random pose with unequal focal lengths and a principal point off the centre.
inline Camera random_camera(Rng& rng, ImageSize size) {
  Camera camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = size.width * uniform(rng, 0.7, 1.3) + 4;
  camera.fy = camera.fx * uniform(rng, 0.8, 1.25);
  camera.cx = size.width * uniform(rng, 0.3, 0.7);
  camera.cy = size.height * uniform(rng, 0.3, 0.7);
  camera.rotation_cam_from_world = rotation_from_quaternion(random_unit_quaternion(rng));
  camera.translation_cam_from_world = uniform(rng, 0, 3) * random_direction(rng);
  return camera;
}

// Shares of the kinds of surfels; what remains is ordinary.
struct RandomSurfels {
  std::size_t count = 100;
  int channels = 3;
  double min_sigma_px = 0.5, max_sigma_px = 20;  // of ordinary ones, seen face on
  double min_depth = 0.6, max_depth = 8;         // metres
  double min_opacity = 0.02, max_opacity = 1;
  double edge_on = 0;    // seen under 0.05 to 5 degrees
  double at_camera = 0;  // touch or cross the camera plane, centres on both sides of it
  double behind = 0;     // wholly behind the camera
  double huge = 0;       // 5 to 50 m
  double tiny = 0;       // 1e-3 to 0.1 pixels: the low-pass alone
};

// A quaternion (unit) whose third axis is `normal`, spun about it at random.
inline Vec4<double> quaternion_with_normal(Rng& rng, Vec3d normal) {
  const Vec3d u = normalize(cross(normal, random_direction(rng)));
  const Vec3d v = cross(normal, u);
  return quaternion_from_rotation(transpose(Mat3d{{u, v, normal}}));
}

inline Vec3d random_point_in_view(Rng& rng, const Camera& camera, double depth) {
  const double x = camera.width * uniform(rng, -0.2, 1.2);
  const double y = camera.height * uniform(rng, -0.2, 1.2);
  return depth * camera.ray_in_cam(x, y);
}

// One surfel of random kind.
inline void add_random_surfel(
    SurfelArrays& surfels, const RandomSurfels& options, const Camera& camera, Rng& rng
) {
  const double depth = log_uniform(rng, options.min_depth, options.max_depth);
  const double metres_per_px = depth / camera.fx;
  Vec3d in_cam = random_point_in_view(rng, camera, depth);
  double size = metres_per_px * log_uniform(rng, options.min_sigma_px, options.max_sigma_px);
  Vec4<double> q = random_unit_quaternion(rng);

  double kind = uniform(rng, 0, 1);
  const auto is = [&](double share) { return (kind -= share) < 0; };
  if (is(options.edge_on)) {
    const Vec3d ray = normalize(in_cam), side = normalize(cross(ray, random_direction(rng)));
    const double angle = log_uniform(rng, 0.05, 5) * std::numbers::pi / 180;
    const Vec3d normal = std::cos(angle) * side + std::sin(angle) * ray;
    q = quaternion_with_normal(rng, transpose_times(camera.rotation_cam_from_world, normal));
  } else if (is(options.at_camera)) {
    in_cam = uniform(rng, 0.2, 1.5) * random_direction(rng);
    size = log_uniform(rng, 0.3, 2);
  } else if (is(options.behind)) {
    in_cam.z = -in_cam.z - 0.5;
    size *= 0.05;
  } else if (is(options.huge)) {
    size = log_uniform(rng, 5, 50);
  } else if (is(options.tiny)) {
    size = metres_per_px * log_uniform(rng, 1e-3, 0.1);
  }
  const Vec2d scale{size, size * log_uniform(rng, 0.4, 2.5)};
  std::vector<float> feature;
  for (int c = 0; c < surfels.channels; ++c) feature.push_back(rng.uniform());
  const double opacity = uniform(rng, options.min_opacity, options.max_opacity);
  const double length = uniform(rng, 0.5, 2);  // inputs need not be normalised
  q = {length * q.w, length * q.x, length * q.y, length * q.z};
  surfels.add(camera.to_world(in_cam), scale, q, opacity, feature);
}

inline SurfelArrays random_surfels(const RandomSurfels& options, const Camera& camera, Rng& rng) {
  SurfelArrays surfels;
  surfels.channels = options.channels;
  for (std::size_t i = 0; i < options.count; ++i) add_random_surfel(surfels, options, camera, rng);
  return surfels;
}

}  // namespace glint::test
