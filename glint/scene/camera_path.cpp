// SPDX-License-Identifier: MIT
#include "glint/scene/camera_path.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glint/core/error.h"

namespace glint {

namespace {

// Axes count as parallel when the point's position along them is this uncertain: the smallest over
// the largest eigenvalue of the normal equations.
constexpr double kParallel = 1e-3;
constexpr double kUpright = 0.5;  // cosine between a plane's normal and up, below: not a floor plan
// Of the standard deviations in the centres' plane: the smaller over the larger; below, they stand
// in a row.
constexpr double kRow = 0.05;

Eigen::Vector3d eigen(Vec3d v) { return {v.x, v.y, v.z}; }
Vec3d vec(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Vec3d mean_of(const std::vector<Camera>& cameras, Vec3d (*of)(const Camera&)) {
  Vec3d sum{};
  for (const Camera& camera : cameras) sum += of(camera);
  return (1.0 / static_cast<double>(cameras.size())) * sum;
}

Vec3d center_of(const Camera& camera) { return camera.center(); }
Vec3d up_of(const Camera& camera) { return -camera.rotation_cam_from_world.rows[1]; }
Vec3d forward_of(const Camera& camera) { return camera.rotation_cam_from_world.rows[2]; }

bool inside(Vec3d p, Vec3d low, Vec3d high) {
  for (int i = 0; i < 3; ++i)
    if (p[i] < low[i] || p[i] > high[i]) return false;
  return true;
}

// argmin_p of the squared distances to the axes: sum (I - d d^T) (p - c) = 0.
Vec3d looked_at_point(const std::vector<Camera>& cameras, Vec3d low, Vec3d high) {
  Eigen::Matrix3d left = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Camera& camera : cameras) {
    const Eigen::Vector3d d = eigen(forward_of(camera));
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d * d.transpose();
    left += across;
    right += across * eigen(camera.center());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(left);
  const Vec3d box_center = 0.5 * (low + high);
  if (solver.eigenvalues()[0] < kParallel * solver.eigenvalues()[2]) return box_center;
  const Vec3d point = vec(left.ldlt().solve(right));
  const auto in_front = std::count_if(cameras.begin(), cameras.end(), [&](const Camera& camera) {
    return camera.to_cam(point).z > 0;
  });
  const bool seen = 2 * static_cast<std::size_t>(in_front) > cameras.size();
  return seen && inside(point, low, high) ? point : box_center;
}

// Normal of the centres' plane, to the side of `up`; `up` where they have none that is level.
Vec3d plane_normal(const std::vector<Camera>& cameras, Vec3d mean, Vec3d up) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Camera& camera : cameras) {
    const Eigen::Vector3d d = eigen(camera.center() - mean);
    covariance += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d spread = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  const Vec3d normal = vec(solver.eigenvectors().col(0));
  const double cosine = dot(normal, up);
  if (spread[1] <= kRow * spread[2] || std::abs(cosine) < kUpright) return up;
  return cosine < 0 ? -normal : normal;
}

// A unit vector across `axis`.
Vec3d any_across(Vec3d axis) {
  const Vec3d other = std::abs(axis.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  return normalize(cross(axis, other));
}

// The Catmull-Rom polynomial through p[1] and p[2] at knots t[1] <= x <= t[2], by the pyramid of
// [Barry88].
double catmull_rom(const double (&p)[4], const double (&t)[4], double x) {
  const auto mix = [&](double a, double b, int from, int to) {
    return ((t[to] - x) * a + (x - t[from]) * b) / (t[to] - t[from]);
  };
  const double a1 = mix(p[0], p[1], 0, 1), a2 = mix(p[1], p[2], 1, 2), a3 = mix(p[2], p[3], 2, 3);
  return mix(mix(a1, a2, 0, 2), mix(a2, a3, 1, 3), 1, 2);
}

double angle_between(const Vec4<double>& a, const Vec4<double>& b) {
  const double cosine = std::abs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z);
  return 2 * std::acos(std::min(1.0, cosine));
}

}  // namespace

Orbit fit_orbit(const std::vector<Camera>& cameras, Vec3d low, Vec3d high) {
  GLINT_CHECK(!cameras.empty(), kBadReference, "no camera to fit an orbit to");
  const Vec3d mean = mean_of(cameras, center_of);
  Orbit orbit;
  orbit.target = looked_at_point(cameras, low, high);
  orbit.axis = plane_normal(cameras, mean, normalize(mean_of(cameras, up_of)));
  orbit.center = orbit.target + dot(mean - orbit.target, orbit.axis) * orbit.axis;
  const auto across = [&](const Camera& camera) {
    const Vec3d d = camera.center() - orbit.center;
    return d - dot(d, orbit.axis) * orbit.axis;
  };
  for (const Camera& camera : cameras)
    orbit.radius += length(across(camera)) / static_cast<double>(cameras.size());
  GLINT_CHECK(
      orbit.radius > 0, kBadReference, "all cameras stand on the axis of the orbit; give a radius"
  );
  const Vec3d first = across(cameras.front());
  orbit.start = length(first) > 1e-9 * orbit.radius ? normalize(first) : any_across(orbit.axis);
  return orbit;
}

std::vector<Camera> orbit_cameras(const Orbit& orbit, const Camera& lens, int frames) {
  const Vec3d side = cross(orbit.axis, orbit.start);
  std::vector<Camera> cameras;
  for (int i = 0; i < frames; ++i) {
    const double angle = 2 * std::numbers::pi * i / frames;
    const Vec3d eye =
        orbit.center + orbit.radius * (std::cos(angle) * orbit.start + std::sin(angle) * side);
    const Camera pose = look_at(eye, orbit.target, orbit.axis, lens.size(), 90);
    cameras.push_back(lens);
    cameras.back().rotation_cam_from_world = pose.rotation_cam_from_world;
    cameras.back().translation_cam_from_world = pose.translation_cam_from_world;
  }
  return cameras;
}

CameraSpline::CameraSpline(const std::vector<Camera>& keys) {
  constexpr double kSame = 1e-9;  // metres and radians
  for (const Camera& key : keys) {
    const Vec3d c = key.center();
    Vec4<double> q = quaternion_from_rotation(key.rotation_cam_from_world);
    if (!poses_.empty()) {
      const Pose& last = poses_.back();
      const Vec4<double> before{last[3], last[4], last[5], last[6]};
      if (length(c - Vec3d{last[0], last[1], last[2]}) < kSame && angle_between(before, q) < kSame)
        continue;
      // q and -q are the same rotation; the near one is on the short way.
      const double sign = before.w * q.w + before.x * q.x + before.y * q.y + before.z * q.z;
      if (sign < 0) q = {-q.w, -q.x, -q.y, -q.z};
    }
    poses_.push_back({c.x, c.y, c.z, q.w, q.x, q.y, q.z});
  }
  GLINT_CHECK(
      poses_.size() >= 2,
      kBadReference,
      "a path needs two different cameras, found {}",
      poses_.size()
  );
  lens_ = keys.front();
  // Knots as far apart as the cameras, where a mean distance counts as much as a radian.
  const auto distance = [&](std::size_t i) {
    const Pose &a = poses_[i - 1], &b = poses_[i];
    return length(Vec3d{b[0] - a[0], b[1] - a[1], b[2] - a[2]});
  };
  double mean = 0;
  for (std::size_t i = 1; i < poses_.size(); ++i)
    mean += distance(i) / static_cast<double>(poses_.size() - 1);
  knots_.push_back(0);
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    const Pose &a = poses_[i - 1], &b = poses_[i];
    const double angle = angle_between({a[3], a[4], a[5], a[6]}, {b[3], b[4], b[5], b[6]});
    knots_.push_back(knots_.back() + (mean > 0 ? distance(i) / mean : 0) + angle);
  }
}

CameraSpline::Pose CameraSpline::pose(std::ptrdiff_t i) const {
  const auto last = static_cast<std::ptrdiff_t>(poses_.size()) - 1;
  if (i >= 0 && i <= last) return poses_[static_cast<std::size_t>(i)];
  const Pose &end = i < 0 ? poses_.front() : poses_.back(),
             &next = i < 0 ? poses_[1] : poses_[static_cast<std::size_t>(last) - 1];
  Pose mirrored;
  for (std::size_t k = 0; k < end.size(); ++k) mirrored[k] = 2 * end[k] - next[k];
  return mirrored;
}

double CameraSpline::knot(std::ptrdiff_t i) const {
  const auto last = static_cast<std::ptrdiff_t>(knots_.size()) - 1;
  if (i < 0) return -knots_[1];
  if (i > last) return 2 * knots_.back() - knots_[static_cast<std::size_t>(last) - 1];
  return knots_[static_cast<std::size_t>(i)];
}

Camera CameraSpline::at(double t) const {
  const double x = std::clamp(t, 0.0, knots_.back());
  const auto above = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, x);
  const std::ptrdiff_t i = above - knots_.begin() - 1;  // the piece from key i to i + 1
  const double knots[4] = {knot(i - 1), knot(i), knot(i + 1), knot(i + 2)};
  const Pose poses[4] = {pose(i - 1), pose(i), pose(i + 1), pose(i + 2)};
  Pose p;
  for (std::size_t k = 0; k < p.size(); ++k)
    p[k] = catmull_rom({poses[0][k], poses[1][k], poses[2][k], poses[3][k]}, knots, x);
  const double norm = std::sqrt(p[3] * p[3] + p[4] * p[4] + p[5] * p[5] + p[6] * p[6]);
  Camera camera = lens_;
  camera.rotation_cam_from_world =
      rotation_from_quaternion({p[3] / norm, p[4] / norm, p[5] / norm, p[6] / norm});
  camera.translation_cam_from_world = -(camera.rotation_cam_from_world * Vec3d{p[0], p[1], p[2]});
  return camera;
}

std::vector<Camera> CameraSpline::frames(int count) const {
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i)
    cameras.push_back(at(count > 1 ? knots_.back() * i / (count - 1) : 0));
  return cameras;
}

Camera with_size(const Camera& camera, ImageSize size) {
  const double scale = static_cast<double>(size.width) / camera.width;
  Camera result = camera;
  result.width = size.width;
  result.height = size.height;
  result.fx *= scale;
  result.fy *= scale;
  result.cx *= scale;
  result.cy = 0.5 * size.height + (camera.cy - 0.5 * camera.height) * scale;
  return result;
}

}  // namespace glint
