// SPDX-License-Identifier: MIT
// A camera as kernels read it: rays of pixels, projection, and the way from one camera to another.
// Conventions of glint/scene/camera.h.
#pragma once

#include "glint/scene/camera.h"

namespace glint {

template <class T>
struct Pinhole {
  int width, height;  // pixels
  T fx, fy, cx, cy;   // pixels
  T step_x, step_y;   // of a ray from one pixel to the next: 1 / fx, 1 / fy

  // Through the centre of pixel (x, y), camera-space z = 1.
  GLINT_HD Vec3<T> ray(int x, int y) const {
    return {(T(x) + T(0.5) - cx) * step_x, (T(y) + T(0.5) - cy) * step_y, T(1)};
  }
  // Image point of a camera-space point with z > 0.
  GLINT_HD Vec2<T> project(Vec3<T> p) const { return {fx * p.x / p.z + cx, fy * p.y / p.z + cy}; }
  GLINT_HD void project_vjp(Vec3<T> p, Vec2<T> dL_dimage_point, Vec3<T>& dL_dp) const {
    const T gx = dL_dimage_point.x * fx / p.z, gy = dL_dimage_point.y * fy / p.z;
    dL_dp += Vec3<T>{gx, gy, -(gx * p.x + gy * p.y) / p.z};
  }
};

template <class T>
Pinhole<T> pinhole_of(const Camera& camera) {
  return {
      camera.width,
      camera.height,
      static_cast<T>(camera.fx),
      static_cast<T>(camera.fy),
      static_cast<T>(camera.cx),
      static_cast<T>(camera.cy),
      static_cast<T>(1 / camera.fx),
      static_cast<T>(1 / camera.fy)};
}

// Two views of a scene: x_neighbor = rotation x_reference + translation.
template <class T>
struct CameraPair {
  Pinhole<T> reference, neighbor;
  Mat3<T> rotation;
  Vec3<T> translation;  // metres

  GLINT_HD Vec3<T> to_neighbor(Vec3<T> in_reference) const {
    return rotation * in_reference + translation;
  }
  GLINT_HD Vec3<T> to_reference(Vec3<T> in_neighbor) const {
    return transpose_times(rotation, in_neighbor - translation);
  }
};

template <class T>
CameraPair<T> camera_pair(const Camera& reference, const Camera& neighbor) {
  const Mat3d rotation =
      neighbor.rotation_cam_from_world * transpose(reference.rotation_cam_from_world);
  const Vec3d translation =
      neighbor.translation_cam_from_world - rotation * reference.translation_cam_from_world;
  return {
      pinhole_of<T>(reference), pinhole_of<T>(neighbor), cast<T>(rotation), cast<T>(translation)};
}

}  // namespace glint
