// SPDX-License-Identifier: MIT
// A textured plane seen by two cameras of different focal lengths along x and y and principal
// points off the centre: depth, normals, distances and photos in closed form.
#pragma once

#include <cmath>

#include "glint/core/image.h"
#include "glint/core/rng.h"
#include "glint/scene/camera.h"
#include "tests/support/check_loss.h"

namespace glint::test {

inline Mat3d unit_rotation(Vec4<double> q) {
  const double norm = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return rotation_from_quaternion({q.w / norm, q.x / norm, q.y / norm, q.z / norm});
}

struct TwoViews {
  Camera reference, neighbor;
  Vec3d normal = normalize(Vec3d{0.25, -0.15, -1});  // in the reference's camera, towards it
  double distance = 2.5;                             // metres, -n.p

  explicit TwoViews(ImageSize size = {24, 18}) {
    reference.width = neighbor.width = size.width;
    reference.height = neighbor.height = size.height;
    reference.fx = 22, reference.fy = 19, reference.cx = 0.43 * size.width;
    reference.cy = 0.56 * size.height;
    neighbor.fx = 20, neighbor.fy = 23, neighbor.cx = 0.52 * size.width;
    neighbor.cy = 0.47 * size.height;
    reference.rotation_cam_from_world = unit_rotation({0.9, 0.1, -0.3, 0.2});
    reference.translation_cam_from_world = {0.3, -0.2, 0.4};
    const Mat3d turn = unit_rotation({0.998, 0.01, -0.05, 0.02});
    neighbor.rotation_cam_from_world = turn * reference.rotation_cam_from_world;
    neighbor.translation_cam_from_world =
        turn * reference.translation_cam_from_world + Vec3d{-0.15, 0.1, 0.05};
  }

  // The plane in the other camera's axes: n' = R n, d' = d - n'.t.
  Vec3d neighbor_normal() const {
    return neighbor.rotation_cam_from_world *
           transpose_times(reference.rotation_cam_from_world, normal);
  }
  double neighbor_distance() const {
    const Vec3d t = neighbor.translation_cam_from_world -
                    neighbor.rotation_cam_from_world *
                        transpose_times(
                            reference.rotation_cam_from_world, reference.translation_cam_from_world
                        );
    return distance - dot(neighbor_normal(), t);
  }

  template <class T>
  BasicImage<T> depth(bool of_neighbor) const {
    const Camera& camera = of_neighbor ? neighbor : reference;
    const Vec3d n = of_neighbor ? neighbor_normal() : normal;
    const double d = of_neighbor ? neighbor_distance() : distance;
    BasicImage<T> map(camera.width, camera.height, 1);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x)
        map.at(x, y) = static_cast<T>(d / -dot(n, camera.ray_in_cam(x + 0.5, y + 0.5)));
    return map;
  }
  // A smooth pattern painted on the plane.
  Image photo(bool of_neighbor) const {
    const Camera& camera = of_neighbor ? neighbor : reference;
    const BasicImage<double> z = depth<double>(of_neighbor);
    Image gray(camera.width, camera.height, 1);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const Vec3d p = camera.to_world(z.at(x, y) * camera.ray_in_cam(x + 0.5, y + 0.5));
        gray.at(x, y) = static_cast<float>(
            0.5 + 0.2 * std::sin(4 * p.x + 3 * p.z) + 0.2 * std::cos(5 * p.y - 2 * p.x)
        );
      }
    return gray;
  }
  // Maps as composited: times a coverage that differs from pixel to pixel.
  template <class T>
  void planes(BasicImage<T>& normals, BasicImage<T>& distances, double noise = 0) const {
    Rng rng(5);
    normals = BasicImage<T>(reference.width, reference.height, 3);
    distances = BasicImage<T>(reference.width, reference.height, 1);
    const auto off = [&] { return noise * static_cast<double>(rng.uniform(-1, 1)); };
    for (std::size_t i = 0; i < distances.num_pixels(); ++i) {
      const double coverage = static_cast<double>(rng.uniform(0.6f, 1));
      for (int c = 0; c < 3; ++c)
        normals.data()[3 * i + static_cast<std::size_t>(c)] =
            static_cast<T>(coverage * (normal[c] + off()));
      distances.data()[i] = static_cast<T>(coverage * (distance + off()));
    }
  }
};

template <class T>
BasicImage<T> with_noise(BasicImage<T> map, double noise, std::uint64_t seed) {
  Rng rng(seed);
  for (T& value : map.values())
    value += static_cast<T>(noise * static_cast<double>(rng.uniform(-1, 1)));
  return map;
}

}  // namespace glint::test
