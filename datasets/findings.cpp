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
  const double error = rotation_error(camera.rotation_cam_from_world);
  if (error <= 1e-3) return std::nullopt;
  return Finding{
      "pose",
      where,
      fmt::format("it holds no rotation (off by {:.2g}); remove scale, shear or mirroring", error)};
}

}  // namespace glint
