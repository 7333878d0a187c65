// SPDX-License-Identifier: MIT
#include "glint/render/plane_depth.h"

#include "glint/render/map_ops.h"
#include "tests/support/check_vjp.h"
#include "tests/support/two_views.h"

using namespace glint;
using namespace glint::test;

TEST_CASE("A plane's depth is the plane's, whatever share of the pixel it covers") {
  const TwoViews views;
  Image normal, distance, depth;
  views.planes(normal, distance);
  plane_depth_map(views.reference, distance, normal, depth);
  const ImageD expected = views.depth<double>(false);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    CHECK(static_cast<double>(depth.data()[i]) == Approx(expected.data()[i]).epsilon(1e-5));
}

TEST_CASE("Where nothing was hit, or a plane is seen edge-on or from behind, there is no depth") {
  const Vec3d ray{0.1, 0.2, 1};
  CHECK(plane_depth(0.0, {0, 0, 0}, ray) == 0);
  CHECK(plane_depth(1.0, {0, 0, 1}, ray) == 0);
  CHECK(plane_depth(1.0, {1, -0.5, 0}, ray) == 0);
  CHECK(plane_depth(-1.0, {0, 0, -1}, ray) == 0);
  double dL_dd = 0;
  Vec3d dL_dn{};
  plane_depth_vjp(1.0, {0, 0, 1}, ray, 1.0, dL_dd, dL_dn);
  CHECK(dL_dd == 0);
  CHECK(length(dL_dn) == 0);
}

TEST_CASE("Plane depth has the gradient of its differences") {
  const Vec3d ray{0.3, -0.2, 1};
  check_formula(
      [&](double distance, Vec3d n) { return plane_depth(distance, n, ray); },
      [&](double distance, Vec3d n, double g, double& dL_dd, Vec3d& dL_dn) {
        plane_depth_vjp(distance, n, ray, g, dL_dd, dL_dn);
      },
      1.8,
      Vec3d{0.2, 0.1, -0.7}
  );
}

TEST_CASE("The way back of the map adds each pixel's gradient") {
  const TwoViews views;
  Image normal, distance;
  views.planes(normal, distance, 0.1);
  const Image g = random_map<float>(distance.size(), 1, -1, 1, 3);
  Image dL_dd(distance.width(), distance.height(), 1, 2.0f);
  Image dL_dn(distance.width(), distance.height(), 3, 3.0f);
  plane_depth_map_vjp(views.reference, distance, normal, g, dL_dd, dL_dn);
  for (int y = 0; y < distance.height(); ++y)
    for (int x = 0; x < distance.width(); ++x) {
      const float* n = normal.pixel(x, y);
      double d = 2;
      Vec3d expected{3, 3, 3};
      plane_depth_vjp(
          static_cast<double>(distance.at(x, y)),
          cast<double>(Vec3f{n[0], n[1], n[2]}),
          views.reference.ray_in_cam(x + 0.5, y + 0.5),
          static_cast<double>(g.at(x, y)),
          d,
          expected
      );
      CHECK(static_cast<double>(dL_dd.at(x, y)) == Approx(d).epsilon(1e-4));
      for (int c = 0; c < 3; ++c)
        CHECK(
            static_cast<double>(dL_dn.at(x, y, c)) == Approx(expected[c]).epsilon(1e-4).margin(1e-5)
        );
    }
}
