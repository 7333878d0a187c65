// SPDX-License-Identifier: MIT
// Pinhole camera. Camera axes: x right, y down, z forward (OpenCV). Pixel centres at +0.5.
#pragma once

#include "glint/core/image.h"
#include "glint/core/vec.h"

namespace glint {

struct Camera {
  int width = 0, height = 0;  // pixels
  double fx = 0, fy = 0;      // pixels
  double cx = 0, cy = 0;      // pixels; (width/2, height/2) when centred
  Mat3d rotation_cam_from_world{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3d translation_cam_from_world{};  // x_cam = R x_world + t

  ImageSize size() const { return {width, height}; }
  Vec3d to_cam(Vec3d world) const {
    return rotation_cam_from_world * world + translation_cam_from_world;
  }
  Vec3d to_world(Vec3d cam) const {
    return transpose_times(rotation_cam_from_world, cam - translation_cam_from_world);
  }
  // Camera centre in the world: -R^T t.
  Vec3d center() const {
    return -transpose_times(rotation_cam_from_world, translation_cam_from_world);
  }
  // Direction through image point (x, y) in camera space with z = 1, so that a ray's parameter is
  // planar depth. The centre of pixel (i, j) is (i + 0.5, j + 0.5).
  Vec3d ray_in_cam(double x, double y) const { return {(x - cx) / fx, (y - cy) / fy, 1.0}; }
  Vec3d ray_in_world(double x, double y) const {
    return transpose_times(rotation_cam_from_world, ray_in_cam(x, y));
  }
  // Image point of a camera-space point with z > 0.
  Vec2d project(Vec3d cam) const { return {fx * cam.x / cam.z + cx, fy * cam.y / cam.z + cy}; }
};

// Distances along rays, [H][W][1], become planar z: divided by the length of the ray with z = 1.
void make_planar(Image& ray_lengths, const Camera& camera);

// The same view at another image size (intrinsics scaled by the ratio of sizes).
Camera resized(const Camera& camera, ImageSize size);

// Camera at `eye` looking at `target`; `up` is a world direction that points up in the image.
// fov_x_deg: horizontal field of view in degrees; principal point centred.
Camera look_at(Vec3d eye, Vec3d target, Vec3d up, ImageSize size, double fov_x_deg);

// Rotation matrix of a unit quaternion (w, x, y, z) and back.
Mat3d rotation_from_quaternion(Vec4<double> q);
Vec4<double> quaternion_from_rotation(const Mat3d& rotation);

}  // namespace glint
