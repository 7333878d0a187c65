// SPDX-License-Identifier: MIT
#include "glint/scene/camera.h"

#include <cmath>
#include <numbers>

namespace glint {

void make_planar(Image& ray_lengths, const Camera& camera) {
  for (int y = 0; y < ray_lengths.height(); ++y)
    for (int x = 0; x < ray_lengths.width(); ++x)
      ray_lengths.at(x, y) /= static_cast<float>(length(camera.ray_in_cam(x + 0.5, y + 0.5)));
}

Camera resized(const Camera& camera, ImageSize size) {
  const double sx = static_cast<double>(size.width) / camera.width;
  const double sy = static_cast<double>(size.height) / camera.height;
  Camera result = camera;
  result.width = size.width;
  result.height = size.height;
  result.fx *= sx;
  result.cx *= sx;
  result.fy *= sy;
  result.cy *= sy;
  return result;
}

Camera look_at(Vec3d eye, Vec3d target, Vec3d up, ImageSize size, double fov_x_deg) {
  const Vec3d forward = normalize(target - eye);
  const Vec3d right = normalize(cross(forward, up));
  const Vec3d down = cross(forward, right);
  Camera camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = camera.fy = 0.5 * size.width / std::tan(fov_x_deg * std::numbers::pi / 360.0);
  camera.cx = 0.5 * size.width;
  camera.cy = 0.5 * size.height;
  camera.rotation_cam_from_world = {{right, down, forward}};
  camera.translation_cam_from_world = -(camera.rotation_cam_from_world * eye);
  return camera;
}

Mat3d rotation_from_quaternion(Vec4<double> q) { return rotation_of_unit(q); }

Vec4<double> quaternion_from_rotation(const Mat3d& m) {
  // Shepperd: divide by the largest of the four squared components.
  const double xx = m.rows[0].x, yy = m.rows[1].y, zz = m.rows[2].z;
  const double squares[4] = {
      1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz};
  int largest = 0;
  for (int i = 1; i < 4; ++i)
    if (squares[i] > squares[largest]) largest = i;
  const double p = std::sqrt(squares[largest]);
  const double s = 0.5 / p;
  const double a = (m.rows[2].y - m.rows[1].z) * s, b = (m.rows[0].z - m.rows[2].x) * s,
               c = (m.rows[1].x - m.rows[0].y) * s, d = (m.rows[1].x + m.rows[0].y) * s,
               e = (m.rows[2].x + m.rows[0].z) * s, f = (m.rows[2].y + m.rows[1].z) * s;
  switch (largest) {
    case 0:
      return {0.5 * p, a, b, c};
    case 1:
      return {a, 0.5 * p, d, e};
    case 2:
      return {b, d, 0.5 * p, f};
    default:
      return {c, e, f, 0.5 * p};
  }
}

}  // namespace glint
