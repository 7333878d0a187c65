// SPDX-License-Identifier: MIT
#include "datasets/findings.h"

#include <algorithm>
#include <cmath>

#include "glint/core/error.h"

namespace glint {
namespace {

double rotation_error(const Mat3d& r) {
  double error = std::abs(determinant(r) - 1);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      error = std::max(error, std::abs(dot(r.rows[i], r.rows[j]) - (i == j ? 1.0 : 0.0)));
  return error;
}

// Degrees that the longer side spans. Some datasets state no size: the middle is about half of it.
double view_angle(const Camera& camera) {
  constexpr double kDegrees = 180 / 3.141592653589793;
  const double width = camera.width > 0 ? camera.width : 2 * camera.cx;
  const double height = camera.height > 0 ? camera.height : 2 * camera.cy;
  return 2 * kDegrees * std::atan(0.5 * std::max(width / camera.fx, height / camera.fy));
}

// No lens of a scene that is walked through; a lens that sees more is no pinhole.
std::optional<Finding> view_angle_problem(const Camera& camera, const std::string& where) {
  constexpr double kLeast = 1, kMost = 175;  // degrees
  if (camera.width <= 0 && !(camera.cx > 0 && camera.cy > 0)) return std::nullopt;
  const double angle = view_angle(camera);
  if (angle >= kLeast && angle <= kMost) return std::nullopt;
  return Finding{
      "intrinsics",
      where,
      fmt::format(
          "focal lengths {:g} and {:g} make a field of view of {:.3g} degrees; expected {} to {}: "
          "are they pixels?",
          camera.fx,
          camera.fy,
          angle,
          kLeast,
          kMost
      )};
}

}  // namespace

Finding make_finding(const std::string& check, const std::string& where, std::string message) {
  if (message.starts_with(where + ": ")) message.erase(0, where.size() + 2);
  return {check, where, message};
}

bool is_off_center(const Camera& camera) {
  if (camera.width <= 0 || camera.height <= 0) return false;
  constexpr double kOffCenter = 0.25;  // of the side
  const double dx = std::abs(camera.cx / camera.width - 0.5);
  const double dy = std::abs(camera.cy / camera.height - 0.5);
  return std::max(dx, dy) > kOffCenter;
}

std::optional<Finding> camera_problem(const Camera& camera, const std::string& where) {
  if (!std::isfinite(camera.fx + camera.fy + camera.cx + camera.cy))
    return Finding{"non-finite", where, "the intrinsics are not finite"};
  for (int i = 0; i < 3; ++i) {
    const Vec3d& row = camera.rotation_cam_from_world.rows[i];
    if (!std::isfinite(row.x + row.y + row.z + camera.translation_cam_from_world[i]))
      return Finding{"non-finite", where, "the pose is not finite"};
  }
  constexpr double kFarthest = 1e6;  // metres
  const double distance = length(camera.translation_cam_from_world);
  if (distance > kFarthest)
    return Finding{
        "pose",
        where,
        fmt::format(
            "the camera stands {:g} m from the origin; expected at most {:g}: the pose is damaged, "
            "or "
            "in another unit",
            distance,
            kFarthest
        )};
  if (!(camera.fx > 0 && camera.fy > 0)) {
    return Finding{
        "intrinsics",
        where,
        fmt::format("focal lengths {} and {}; expected positive ones", camera.fx, camera.fy)};
  }
  if (auto problem = view_angle_problem(camera, where)) return problem;
  const double error = rotation_error(camera.rotation_cam_from_world);
  if (error <= 1e-3) return std::nullopt;
  return Finding{
      "pose",
      where,
      fmt::format("it holds no rotation (off by {:.2g}); remove scale, shear or mirroring", error)};
}

}  // namespace glint
