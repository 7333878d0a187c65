// SPDX-License-Identifier: MIT
#include "glint/scene/camera.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/random_scene.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr double kMargin = 1e-12;

void check_equal(Vec3d actual, Vec3d expected) {
  for (int i = 0; i < 3; ++i) CHECK(actual[i] == Approx(expected[i]).margin(kMargin));
}

void check_rotation(const Mat3d& r) {
  const Mat3d product = r * transpose(r);
  check_equal(product.rows[0], {1, 0, 0});
  check_equal(product.rows[1], {0, 1, 0});
  check_equal(product.rows[2], {0, 0, 1});
  CHECK(determinant(r) == Approx(1));
}

}  // namespace

TEST_CASE("Projecting a point on a ray gives the ray's image point, for any camera") {
  Rng rng(1);
  for (int i = 0; i < 20; ++i) {
    const Camera camera = random_camera(rng, {64, 48});
    const double x = uniform(rng, -10, 70), y = uniform(rng, -10, 60), depth = uniform(rng, 0.1, 9);
    const Vec3d world = camera.center() + depth * camera.ray_in_world(x, y);
    const Vec3d in_cam = camera.to_cam(world);
    CHECK(in_cam.z == Approx(depth));  // the ray's parameter is planar depth
    CHECK(camera.project(in_cam).x == Approx(x));
    CHECK(camera.project(in_cam).y == Approx(y));
  }
}

TEST_CASE("World and camera space are inverse to each other and share the camera's centre") {
  Rng rng(2);
  const Camera camera = random_camera(rng, {64, 48});
  check_rotation(camera.rotation_cam_from_world);
  const Vec3d point{1, -2, 3};
  check_equal(camera.to_world(camera.to_cam(point)), point);
  check_equal(camera.to_cam(camera.center()), {0, 0, 0});
}

TEST_CASE("A camera looks at its target with up pointing up") {
  const Camera camera = look_at({3, 1, 2}, {0, 0, 1}, {0, 0, 1}, {80, 60}, 90);
  check_rotation(camera.rotation_cam_from_world);
  check_equal(camera.center(), {3, 1, 2});
  const Vec3d target = camera.to_cam({0, 0, 1});
  CHECK(target.x == Approx(0).margin(kMargin));
  CHECK(target.y == Approx(0).margin(kMargin));
  CHECK(target.z == Approx(std::sqrt(11.0)));
  CHECK(camera.project(camera.to_cam({0, 0, 1.5})).y < 30);  // higher in the world, higher up
  // Seen from +x towards the origin with z up, +y lies to the right.
  CHECK(camera.project(camera.to_cam({0, 0.5, 1})).x > 40);
}

TEST_CASE("The horizontal field of view spans the image's width") {
  const Camera camera = look_at({0, 0, 0}, {0, 0, 1}, {0, -1, 0}, {80, 60}, 90);
  CHECK(camera.fx == Approx(40));
  CHECK(camera.fy == Approx(40));
  CHECK(camera.cx == 40);
  CHECK(camera.cy == 30);
  check_equal(camera.ray_in_cam(0, 30), {-1, 0, 1});
  check_equal(camera.ray_in_cam(80, 30), {1, 0, 1});
}

TEST_CASE("Resizing keeps every ray at its relative place in the image") {
  Rng rng(3);
  const Camera camera = random_camera(rng, {64, 48});
  const Camera small = resized(camera, {32, 12});
  CHECK(small.size() == ImageSize{32, 12});
  for (const double x : {0.0, 10.0, 64.0})
    check_equal(small.ray_in_world(x / 2, 5), camera.ray_in_world(x, 20));
  check_equal(small.center(), camera.center());
}

TEST_CASE("Quaternions and rotation matrices convert both ways, up to sign") {
  Rng rng(4);
  for (int i = 0; i < 200; ++i) {
    const Vec4<double> q = random_unit_quaternion(rng);
    const Mat3d rotation = rotation_from_quaternion(q);
    check_rotation(rotation);
    const Vec4<double> back = quaternion_from_rotation(rotation);
    CHECK(std::abs(q.w * back.w + q.x * back.x + q.y * back.y + q.z * back.z) == Approx(1));
  }
}

TEST_CASE("Half turns, where the quaternion's scalar part vanishes, convert too") {
  for (const Vec3d axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{0.6, 0, 0.8}}) {
    const Mat3d rotation = rotation_from_quaternion({0, axis.x, axis.y, axis.z});
    const Vec4<double> q = quaternion_from_rotation(rotation);
    CHECK(q.w == Approx(0).margin(kMargin));
    CHECK(std::abs(dot(Vec3d{q.x, q.y, q.z}, axis)) == Approx(1));
  }
}
