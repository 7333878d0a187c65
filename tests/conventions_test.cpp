// SPDX-License-Identifier: MIT
// One assertion a line of docs/reference/conventions.md, as far as they concern axes, pixels and
// layouts.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "glint/render/rasterize.h"
#include "tests/support/random_scene.h"

using namespace glint;
using namespace glint::test;

namespace {

void check_equal(Vec3d actual, Vec3d expected) {
  for (int i = 0; i < 3; ++i) CHECK(actual[i] == Approx(expected[i]).margin(1e-12));
}

// At the world's origin, axes aligned, focal length 10.
Camera plain_camera() {
  Camera camera;
  camera.width = 8;
  camera.height = 6;
  camera.fx = camera.fy = 10;
  camera.cx = 4;
  camera.cy = 3;
  return camera;
}

RasterOutput render_one(Vec3d mean, Vec4<double> q, Vec2d scale) {
  SurfelArrays surfels;
  surfels.add(mean, scale, q, 0.9, {0.25f, 0.5f, 0.75f});
  Rasterizer rasterizer;
  return rasterizer.forward({surfels.view(), plain_camera(), {}});
}

}  // namespace

TEST_CASE("Camera axes are x right, y down, z forward") {
  const Camera camera = plain_camera();
  CHECK(camera.project({0.1, 0, 1}).x > camera.cx);  // right in the image
  CHECK(camera.project({0, 0.1, 1}).y > camera.cy);  // further down: rows count downwards
  check_equal(camera.ray_in_cam(camera.cx, camera.cy), {0, 0, 1});
}

TEST_CASE("Poses map world to camera: x_cam = R x_world + t") {
  Camera camera = plain_camera();
  camera.rotation_cam_from_world = {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}};
  camera.translation_cam_from_world = {0, 0, 5};
  check_equal(camera.to_cam({1, 0, 0}), {0, 1, 5});
  check_equal(camera.center(), {0, 0, -5});
}

TEST_CASE("The world is right-handed: cross products of axes follow the right hand") {
  check_equal(cross(Vec3d{1, 0, 0}, Vec3d{0, 1, 0}), {0, 0, 1});
  const Camera camera = look_at({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {8, 6}, 60);
  check_equal(camera.rotation_cam_from_world.rows[0], {0, -1, 0});  // z up, facing x: -y is right
}

TEST_CASE("Pixel centres lie at one half") {
  // A tiny surfel on the centre of pixel (5, 2) is brightest there and symmetric about it.
  const Vec3d mean = 2.0 * plain_camera().ray_in_cam(5.5, 2.5);
  const Image alpha = render_one(mean, {1, 0, 0, 0}, {1e-4, 1e-4}).alpha;
  CHECK(alpha.at(5, 2) == Approx(0.9));
  CHECK(alpha.at(4, 2) == Approx(alpha.at(6, 2)).epsilon(1e-4));
  CHECK(alpha.at(5, 1) == Approx(alpha.at(5, 3)).epsilon(1e-4));
}

TEST_CASE("Quaternions are stored w, x, y, z and turn by the right hand") {
  const double half = std::numbers::pi / 4;  // a quarter turn about z
  const Mat3d rotation = rotation_from_quaternion({std::cos(half), 0, 0, std::sin(half)});
  check_equal(rotation * Vec3d{1, 0, 0}, {0, 1, 0});
  check_equal(rotation_from_quaternion({1, 0, 0, 0}) * Vec3d{1, 2, 3}, {1, 2, 3});

  // In a surfel the same: a long u axis, turned by a quarter, runs down the image.
  const Vec4<double> q{std::cos(half), 0, 0, std::sin(half)};
  const Vec3d mean = 2.0 * plain_camera().ray_in_cam(4.5, 2.5);
  const Image alpha = render_one(mean, q, {0.4, 0.1}).alpha;
  CHECK(alpha.at(4, 4) > 2 * alpha.at(6, 2));
}

TEST_CASE("Depth is planar: the camera's z, not the length of the ray") {
  const RasterOutput output = render_one({0, 0, 2}, {1, 0, 0, 0}, {3, 3});
  CHECK(output.depth_median.at(0, 0) == Approx(2));
  CHECK(output.depth_sum.at(0, 0) == Approx(2 * output.alpha.at(0, 0)));
}

TEST_CASE("Rendered normals are in camera space and face the camera") {
  for (const Vec4<double> q : {Vec4<double>{1, 0, 0, 0}, Vec4<double>{0, 1, 0, 0}}) {
    const RasterOutput output = render_one({0, 0, 2}, q, {3, 3});
    CHECK(output.normal.at(4, 3, 2) == Approx(-output.alpha.at(4, 3)));
  }
}

TEST_CASE("Images are row-major, channels fastest") {
  Image image(4, 3, 2);
  image.at(1, 2, 1) = 7;
  CHECK(image.values()[(2 * 4 + 1) * 2 + 1] == 7);
  CHECK(image.pixel(1, 2)[1] == 7);
}

TEST_CASE("No background is added to rendered features") {
  const RasterOutput output = render_one({0, 0, 2}, {1, 0, 0, 0}, {0.1, 0.1});
  for (int c = 0; c < 3; ++c) {
    const float feature = 0.25f * static_cast<float>(c + 1);
    CHECK(output.features.at(4, 3, c) == Approx(feature * output.alpha.at(4, 3)));
    CHECK(output.features.at(0, 0, c) == 0.0f);
  }
}
