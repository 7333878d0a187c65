// SPDX-License-Identifier: MIT
#include "datasets/check_geometry.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace glint {
namespace {

constexpr std::size_t kEnoughSamples = 200;
constexpr double kAgreement = 0.05;  // relative

// A grid of about 64 x 64 pixels is plenty for medians and means.
int sample_step(ImageSize size) { return std::max(1, std::max(size.width, size.height) / 64); }

// Camera-space point of pixel (x, y) whose stored depth is `depth`.
Vec3d unproject(const Camera& camera, int x, int y, double depth, DepthKind kind) {
  const Vec3d ray = camera.ray_in_cam(x + 0.5, y + 0.5);
  return (kind == DepthKind::kPlanar ? depth : depth / length(ray)) * ray;
}

double stored_depth_of(Vec3d cam, DepthKind kind) {
  return kind == DepthKind::kPlanar ? cam.z : length(cam);
}

// Depth at an image point, bilinear in 1/depth; nothing beside edges, holes and borders.
std::optional<double> depth_at(ImageView depth, Vec2d point) {
  constexpr double kSmooth = 0.02;  // relative
  const double u = point.x - 0.5, v = point.y - 0.5;
  if (!(u >= 0 && v >= 0 && u < depth.width - 1 && v < depth.height - 1)) return std::nullopt;
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const double z[4] = {
      static_cast<double>(depth.at(x, y)),
      static_cast<double>(depth.at(x + 1, y)),
      static_cast<double>(depth.at(x, y + 1)),
      static_cast<double>(depth.at(x + 1, y + 1))};
  const double low = *std::min_element(z, z + 4), high = *std::max_element(z, z + 4);
  if (!(low > 0) || !(high < (1 + kSmooth) * low)) return std::nullopt;
  const double s = u - x, t = v - y;
  return 1 / ((1 - t) * ((1 - s) / z[0] + s / z[1]) + t * ((1 - s) / z[2] + s / z[3]));
}

// Relative difference of the depth carried from pixel (x, y) to the one stored in `to`; negative:
// in front of it.
std::optional<double> carried_difference(
    const Camera& from,
    int x,
    int y,
    double depth,
    const Camera& to,
    ImageView to_depth,
    DepthKind kind
) {
  const Vec3d point = to.to_cam(from.to_world(unproject(from, x, y, depth, kind)));
  if (!(point.z > 1e-6)) return std::nullopt;
  const std::optional<double> stored = depth_at(to_depth, to.project(point));
  if (!stored) return std::nullopt;
  return stored_depth_of(point, kind) / *stored - 1;
}

// Unit normal of the depth map at a pixel, facing the camera, by central differences; nothing where
// the surface bends or ends.
std::optional<Vec3d> normal_from_depth(
    const Camera& camera, ImageView depth, int x, int y, DepthKind kind
) {
  constexpr double kBend = 0.01;  // second difference of depth, relative
  const auto z = [&](int dx, int dy) { return static_cast<double>(depth.at(x + dx, y + dy)); };
  const double center = z(0, 0);
  for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
    const double before = z(-dx, -dy), after = z(dx, dy);
    if (!(before > 0 && after > 0 && center > 0)) return std::nullopt;
    if (std::abs(before + after - 2 * center) > kBend * center) return std::nullopt;
  }
  const auto point = [&](int dx, int dy) {
    return unproject(camera, x + dx, y + dy, z(dx, dy), kind);
  };
  const Vec3d normal = cross(point(0, 1) - point(0, -1), point(1, 0) - point(-1, 0));
  const double norm = length(normal);
  if (!(norm > 0)) return std::nullopt;
  const double toward = dot(normal, point(0, 0)) > 0 ? -1 : 1;
  return (toward / norm) * normal;
}

Vec3d normal_at(ImageView normal, int x, int y) {
  const float* n = normal.pixel(x, y);
  return cast<double>(Vec3f{n[0], n[1], n[2]});
}

Vec3d flip(Vec3d n, int pattern) {
  for (int axis = 0; axis < 3; ++axis)
    if ((pattern >> axis & 1) != 0) n[axis] = -n[axis];
  return n;
}

}  // namespace

void DepthAgreement::add_pair(
    const Camera& from, ImageView from_depth, const Camera& to, ImageView to_depth
) {
  const int step = sample_step(from.size());
  for (int y = step / 2; y < from.height; y += step)
    for (int x = step / 2; x < from.width; x += step) {
      const double depth = static_cast<double>(from_depth.at(x, y));
      if (!(depth > 0)) continue;
      const auto planar = carried_difference(from, x, y, depth, to, to_depth, DepthKind::kPlanar);
      const auto ray = carried_difference(from, x, y, depth, to, to_depth, DepthKind::kRayLength);
      if (!planar || !ray) continue;
      ++num_tested_;
      if (*planar < -kAgreement) ++num_in_front_[0];
      if (*ray < -kAgreement) ++num_in_front_[1];
      if (std::min(std::abs(*planar), std::abs(*ray)) > kAgreement) continue;
      differences_[0].push_back(std::abs(*planar));
      differences_[1].push_back(std::abs(*ray));
    }
}

double DepthAgreement::share_in_front(DepthKind kind) const {
  return static_cast<double>(num_in_front_[kind == DepthKind::kPlanar ? 0 : 1]) /
         static_cast<double>(std::max<std::size_t>(num_tested_, 1));
}

double DepthAgreement::median_error(DepthKind kind) const {
  std::vector<double> differences = differences_[kind == DepthKind::kPlanar ? 0 : 1];
  if (differences.empty()) return 0;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

DepthKind DepthAgreement::best() const {
  const bool ray_fits =
      num_agreeing() >= kEnoughSamples &&
      median_error(DepthKind::kRayLength) < 0.5 * median_error(DepthKind::kPlanar);
  return ray_fits ? DepthKind::kRayLength : DepthKind::kPlanar;
}

void NormalAgreement::add_view(
    const Camera& camera, ImageView depth, DepthKind kind, ImageView normal
) {
  const int step = sample_step(camera.size());
  for (int y = 1 + step / 2; y < camera.height - 1; y += step)
    for (int x = 1 + step / 2; x < camera.width - 1; x += step) {
      const Vec3d stored = normal_at(normal, x, y);
      if (std::abs(length(stored) - 1) > 0.1) continue;
      const std::optional<Vec3d> expected = normal_from_depth(camera, depth, x, y, kind);
      if (!expected) continue;
      ++num_samples_;
      for (int pattern = 0; pattern < 8; ++pattern)
        cosines_[static_cast<std::size_t>(pattern)] += dot(flip(stored, pattern), *expected);
      world_cosine_ += dot(camera.rotation_cam_from_world * stored, *expected);
    }
}

double NormalAgreement::mean_cosine(int pattern) const {
  return cosines_[static_cast<std::size_t>(pattern)] /
         static_cast<double>(std::max<std::size_t>(num_samples_, 1));
}

double NormalAgreement::mean_cosine_world() const {
  return world_cosine_ / static_cast<double>(std::max<std::size_t>(num_samples_, 1));
}

int NormalAgreement::best_pattern() const {
  constexpr double kMargin = 0.1;
  int best = 0;
  for (int pattern = 1; pattern < 8; ++pattern)
    if (mean_cosine(pattern) > mean_cosine(best)) best = pattern;
  return mean_cosine(best) > mean_cosine(0) + kMargin ? best : 0;
}

std::string flipped_axes(int pattern) {
  std::string axes;
  for (int axis = 0; axis < 3; ++axis)
    if ((pattern >> axis & 1) != 0)
      axes += (axes.empty() ? "" : " and ") + std::string(1, "xyz"[axis]);
  return axes.empty() ? "none" : axes;
}

double facing_share(const Camera& camera, ImageView normal) {
  std::size_t facing = 0, all = 0;
  const int step = sample_step(camera.size());
  for (int y = step / 2; y < camera.height; y += step)
    for (int x = step / 2; x < camera.width; x += step) {
      const Vec3d n = normal_at(normal, x, y);
      if (length2(n) == 0) continue;
      ++all;
      if (dot(n, camera.ray_in_cam(x + 0.5, y + 0.5)) < 0) ++facing;
    }
  return all == 0 ? 1 : static_cast<double>(facing) / static_cast<double>(all);
}

}  // namespace glint
