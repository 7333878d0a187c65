// SPDX-License-Identifier: MIT
#include "glint/train/normal_consistency.h"

#include "tests/support/check_loss.h"

using namespace glint;
using namespace glint::test;

namespace {

Camera test_camera(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = 12, camera.fy = 11, camera.cx = 0.4 * width, camera.cy = 0.6 * height;
  return camera;
}

// Depth of the plane n.p = d seen through the pixel centres.
Image plane_depth(const Camera& camera, Vec3d n, double d) {
  Image depth(camera.width, camera.height, 1);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      depth.at(x, y) = static_cast<float>(d / dot(n, camera.ray_in_cam(x + 0.5, y + 0.5)));
  return depth;
}

}  // namespace

TEST_CASE(
    "The normal of a slanted plane's depth is the plane's, off-centre principal point included"
) {
  const Camera camera = test_camera(15, 11);
  const Vec3d n = normalize(Vec3d{0.3, -0.2, -1});
  const Image normals = NormalConsistencyLoss::depth_normals(camera, plane_depth(camera, n, -4));
  for (int y = 1; y < 10; ++y)
    for (int x = 1; x < 14; ++x)
      for (int c = 0; c < 3; ++c)
        CHECK(static_cast<double>(normals.at(x, y, c)) == Approx(n[c]).margin(2e-5));
  CHECK(normals.at(0, 5, 2) == 0.0f);
}

TEST_CASE("Of unit normals the loss is that of the normals divided by their lengths") {
  const Camera camera = test_camera(8, 7);
  Image depth = plane_depth(camera, normalize(Vec3d{0.1, 0.2, -1}), -4);
  Image normal(8, 7, 3), unit(8, 7, 3);
  const Image alpha(8, 7, 1, 0.8f);
  for (std::size_t i = 0; i < normal.num_pixels(); ++i) {
    const Vec3d n{0.2 + 0.01 * static_cast<double>(i), -0.3, -0.5};
    for (int c = 0; c < 3; ++c) {
      normal.data()[3 * i + c] = static_cast<float>(n[c]);
      unit.data()[3 * i + c] = static_cast<float>(normalize(n)[c]);
    }
  }
  NormalConsistencyLoss of_sums, of_units;
  of_units.unit_normals = true;
  Image dL_dn(8, 7, 3), dL_dz(8, 7, 1), unused_n(8, 7, 3), same_z(8, 7, 1), unused_z(8, 7, 1);
  const double loss = of_units.evaluate(camera, normal, depth, alpha, 1, dL_dn, dL_dz);
  CHECK(loss == Approx(of_sums.evaluate(camera, unit, depth, alpha, 1, unused_n, same_z)));
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    CHECK(dL_dz.data()[i] == Approx(same_z.data()[i]).margin(1e-7));
  const auto value = [&] {
    return of_units.evaluate(camera, normal, depth, alpha, 1, unused_n, unused_z);
  };
  check_slopes(normal, dL_dn, value, {0.01f, 1e-5, 2e-5});
}

TEST_CASE("The loss is zero inside for agreeing normals, and borders and holes count as one") {
  const Camera camera = test_camera(12, 10);
  const Vec3d n = normalize(Vec3d{0.1, 0.2, -1});
  Image depth = plane_depth(camera, n, -4), normal(12, 10, 3), alpha(12, 10, 1, 1.0f);
  for (std::size_t i = 0; i < normal.num_pixels(); ++i)
    for (int c = 0; c < 3; ++c) normal.data()[3 * i + c] = static_cast<float>(n[c]);
  Image dL_dn(12, 10, 3), dL_dz(12, 10, 1);
  const double border = (120.0 - 10 * 8) / 120;
  CHECK(
      NormalConsistencyLoss().evaluate(camera, normal, depth, alpha, 1, dL_dn, dL_dz) ==
      Approx(border).margin(1e-6)
  );
  depth.at(5, 5) = 0;  // the four neighbours lose their normal, the pixel itself keeps its own
  CHECK(
      NormalConsistencyLoss().evaluate(camera, normal, depth, alpha, 1, dL_dn, dL_dz) ==
      Approx(border + 4.0 / 120).margin(1e-6)
  );
}

TEST_CASE("Factors weigh the pixels of normal consistency, and its mean is over all of them") {
  const Camera camera = test_camera(12, 10);
  const Image depth = plane_depth(camera, normalize(Vec3d{0.1, 0.2, -1}), -4);
  const Image normal(12, 10, 3), alpha(12, 10, 1, 1.0f);  // no normals: each pixel counts as 1
  Image dL_dn(12, 10, 3), dL_dz(12, 10, 1), factors(12, 10, 1);
  factors.at(3, 4) = 0.5f;
  factors.at(7, 5) = 1;
  CHECK(
      NormalConsistencyLoss().evaluate(camera, normal, depth, alpha, 1, dL_dn, dL_dz, factors) ==
      Approx(1.5 / 120)
  );
  for (int c = 0; c < 3; ++c) {
    CHECK(dL_dn.at(3, 4, c) == Approx(0.5f * dL_dn.at(7, 5, c)));
    CHECK(dL_dn.at(5, 5, c) == 0.0f);
  }
  CHECK(dL_dn.at(7, 5, 2) > 0);
  CHECK_THROWS_WITH(
      NormalConsistencyLoss().evaluate(
          camera, normal, depth, alpha, 1, dL_dn, dL_dz, Image(11, 10, 1)
      ),
      Catch::Contains("weights of normal consistency")
  );
}

TEST_CASE("As a cosine the loss is the weighted mean over pixels that have a normal of the depth") {
  const Camera camera = test_camera(12, 10);
  const Vec3d n = normalize(Vec3d{0.1, 0.2, -1});
  const Image depth = plane_depth(camera, n, -4);
  Image normal(12, 10, 3), alpha(12, 10, 1, 0.3f), factors(12, 10, 1, 0.5f);
  for (std::size_t i = 0; i < normal.num_pixels(); ++i)
    for (int c = 0; c < 3; ++c) normal.data()[3 * i + c] = static_cast<float>(0.3 * n[c]);
  for (int c = 0; c < 3; ++c) normal.at(3, 4, c) *= -1;  // a cosine of -1
  factors.at(0, 0) = 100;                                // at the border, where there is none
  Image dL_dn(12, 10, 3), dL_dz(12, 10, 1);
  NormalConsistencyLoss loss;
  loss.cosine = true;
  CHECK(
      loss.evaluate(camera, normal, depth, alpha, 1, dL_dn, dL_dz, factors) ==
      Approx(2.0 / 80).epsilon(1e-4)
  );
  CHECK(
      loss.evaluate(camera, normal, depth, alpha, 1, dL_dn, dL_dz) == Approx(2.0 / 80).epsilon(1e-4)
  );
}

namespace {

// `loss` on random maps, of weight 0.5.
void check_gradients(
    NormalConsistencyLoss loss, float lowest_normal, Differences depths, Differences normals
) {
  const Camera camera = test_camera(9, 8);
  Rng rng(3);
  Image depth = random_map(rng, {9, 8}, 1, 3, 3.2f);
  Image normal = random_map(rng, {9, 8}, 3, lowest_normal, 1);
  const Image alpha = random_map(rng, {9, 8}, 1, loss.cosine ? 1 : 0.5f, 1);
  const Image factors = random_map(rng, {9, 8}, 1, 0, 1.5f);
  Image dL_dn(9, 8, 3), dL_dz(9, 8, 1);
  loss.evaluate(camera, normal, depth, alpha, 0.5f, dL_dn, dL_dz, factors);
  const auto value = [&] {
    Image a(9, 8, 3), b(9, 8, 1);
    return 0.5 * loss.evaluate(camera, normal, depth, alpha, 0.5f, a, b, factors);
  };
  check_slopes(depth, dL_dz, value, depths);
  check_slopes(normal, dL_dn, value, normals);
}

}  // namespace

TEST_CASE("The gradients of normal consistency match central differences, as a cosine, too") {
  // Depth steps of 1/256: the value's float rounding (1e-7 x 72 pixels) stays below the tolerance.
  NormalConsistencyLoss loss;
  check_gradients(loss, -1, {1.0f / 256, 0.02, 2e-4}, {1.0f / 16, 1e-3, 1e-6});
  loss.cosine = true;
  check_gradients(loss, 0.2f, {1.0f / 256, 0.03, 2.5e-4}, {1.0f / 256, 0.03, 2.5e-4});
}
