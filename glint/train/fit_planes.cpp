// SPDX-License-Identifier: MIT
#include "glint/train/fit_planes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glint/core/median.h"
#include "glint/core/rng.h"

namespace glint {

namespace {

constexpr int kRefinements = 5, kAngles = 90;
constexpr double kOutside = 0.003;  // share of points that may lie beyond each end of a side

bool is_on(const MirrorPlane& plane, const SurfacePoint& point, const PlaneFit& settings) {
  return dot(plane.normal, point.normal) >= settings.min_cosine &&
         std::abs(plane.signed_distance(point.position)) <= settings.tolerance;
}

// The plane of a point and its normal that has the most others on it.
MirrorPlane best_plane(
    const std::vector<SurfacePoint>& points, const PlaneFit& settings, Rng& rng
) {
  MirrorPlane best;
  std::ptrdiff_t most = 0;
  for (int i = 0; i < settings.tries; ++i) {
    const SurfacePoint& seed = points[rng.below(static_cast<std::uint32_t>(points.size()))];
    MirrorPlane plane;
    plane.center = seed.position;
    plane.normal = seed.normal;
    const auto count = std::count_if(points.begin(), points.end(), [&](const SurfacePoint& point) {
      return is_on(plane, point, settings);
    });
    if (count <= most) continue;
    most = count;
    best = plane;
  }
  return best;
}

void refine(PlaneOfPoints& fitted) {
  MirrorPlane& plane = fitted.plane;
  Vec3d normal{};
  std::vector<double> distances;
  for (const SurfacePoint& point : fitted.points) normal += point.normal;
  plane.normal = normalize(normal);
  for (const SurfacePoint& point : fitted.points)
    distances.push_back(plane.signed_distance(point.position));
  plane.center += upper_median(std::move(distances)) * plane.normal;
}

struct Side {
  double middle = 0, half = 0;
};
// What nearly all values fill, if they fill it evenly.
Side side_of(std::vector<double>& values) {
  const auto at = [&](double share) {
    const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    return values[static_cast<std::size_t>(rank)];
  };
  const double low = at(kOutside), high = at(1 - kOutside);
  return {0.5 * (low + high), 0.5 * (high - low) / (1 - 2 * kOutside)};
}

// Where the ways to the points meet the plane.
std::vector<Vec3d> seen_on(const MirrorPlane& plane, const std::vector<SurfacePoint>& points) {
  std::vector<Vec3d> seen;
  for (const SurfacePoint& point : points) {
    const Vec3d ray = point.position - point.eye;
    const double towards = dot(plane.normal, ray), away = plane.signed_distance(point.eye);
    if (towards < 0 && away > 0) seen.push_back(point.eye - (away / towards) * ray);
  }
  return seen;
}

}  // namespace

std::vector<SurfacePoint> points_on(
    const MirrorPlane& plane, const std::vector<SurfacePoint>& points, const PlaneFit& settings
) {
  std::vector<SurfacePoint> on;
  for (const SurfacePoint& point : points)
    if (is_on(plane, point, settings)) on.push_back(point);
  return on;
}

bool lies_on(const MirrorPlane& plane, const MirrorPlane& other, const PlaneFit& settings) {
  return is_on(other, {plane.center, plane.normal, {}}, settings) && other.holds(plane.center);
}

void fit_rectangle(PlaneOfPoints& fitted) {
  const MirrorPlane from = fitted.plane;
  const std::vector<Vec3d> seen = seen_on(from, fitted.points);
  if (seen.empty()) return;
  const Vec3d n = from.normal;
  const Vec3d x = normalize(cross(n, std::abs(n.z) < 0.7 ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0}));
  std::vector<double> along_x(seen.size()), along_y(seen.size());
  double least = 0;
  for (int k = 0; k < kAngles; ++k) {
    const double angle = 0.5 * std::numbers::pi * k / kAngles;
    MirrorPlane turned = from;
    turned.across = std::cos(angle) * x + std::sin(angle) * cross(n, x);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      along_x[i] = dot(seen[i] - from.center, turned.across);
      along_y[i] = dot(seen[i] - from.center, turned.up());
    }
    const Side width = side_of(along_x), height = side_of(along_y);
    const double area = width.half * height.half;
    if (k > 0 && area >= least) continue;
    least = area;
    turned.center = from.center + width.middle * turned.across + height.middle * turned.up();
    turned.half_width = width.half, turned.half_height = height.half;
    fitted.plane = turned;
  }
}

std::vector<PlaneOfPoints> fit_planes(std::vector<SurfacePoint> points, const PlaneFit& settings) {
  std::vector<PlaneOfPoints> planes;
  const double needed = std::max(8.0, settings.min_share * static_cast<double>(points.size()));
  Rng rng(0);
  for (int k = 0; k < settings.max_planes && static_cast<double>(points.size()) >= needed; ++k) {
    PlaneOfPoints fitted{best_plane(points, settings, rng), {}};
    for (int i = 0; i < kRefinements; ++i) {
      fitted.points = points_on(fitted.plane, points, settings);
      if (static_cast<double>(fitted.points.size()) < needed) return planes;
      if (i + 1 < kRefinements) refine(fitted);
    }
    std::erase_if(points, [&](const SurfacePoint& point) {
      return is_on(fitted.plane, point, settings);
    });
    fit_rectangle(fitted);
    planes.push_back(std::move(fitted));
  }
  return planes;
}

}  // namespace glint
