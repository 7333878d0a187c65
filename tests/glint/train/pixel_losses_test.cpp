// SPDX-License-Identifier: MIT
#include "glint/train/pixel_losses.h"

#include "tests/support/check_vjp.h"

using namespace glint;
using namespace glint::test;

TEST_CASE("The normalisation of a composited normal has the gradient of its differences") {
  check_formula(unit_normal<double>, unit_normal_vjp<double>, Vec3d{0.3, -0.2, -0.5});
}

TEST_CASE("No normal stays no normal, without gradient") {
  const Vec3f n = unit_normal(Vec3f{});
  CHECK((n.x == 0 && n.y == 0 && n.z == 0));
  Vec3f g{};
  unit_normal_vjp(Vec3f{}, Vec3f{1, 2, 3}, g);
  CHECK((g.x == 0 && g.y == 0 && g.z == 0));
}

TEST_CASE("The cosine loss has no value and no gradient below its gate") {
  const Vec3d prior{0, 0, -1}, unit{0.8, 0, -0.6};
  Vec3d g{};
  CHECK(gated_normal_loss(unit, prior, 0.5, 0.0) == Approx(0.4));
  CHECK(gated_normal_loss(unit, prior, 0.7, 0.0) == 0);
  gated_normal_loss_vjp(unit, prior, 0.7, 0.0, 1.0, g);
  CHECK(g.z == 0);
  gated_normal_loss_vjp(unit, prior, 0.5, 0.0, 2.0, g);
  CHECK(g.z == 2);
}

TEST_CASE("Cross-entropy and entropy have the gradients of their differences") {
  for (const double p : {0.02, 0.3, 0.98}) {
    check_formula(binary_entropy<double>, binary_entropy_vjp<double>, p);
    check_formula(
        [](double x) { return binary_cross_entropy(x, 0.9); },
        [](double x, double g, double& dL_dp) { binary_cross_entropy_vjp(x, 0.9, g, dL_dp); },
        p
    );
  }
}

TEST_CASE("Entropies have their closed-form values and stay finite at 0 and 1") {
  CHECK(binary_entropy(0.5) == Approx(std::log(2.0)));
  CHECK(binary_cross_entropy(0.25, 1.0) == Approx(std::log(4.0)));
  CHECK(binary_cross_entropy(0.25, 0.0) == Approx(std::log(4.0 / 3)));
  for (const float p : {0.0f, 1.0f}) {
    CHECK(static_cast<double>(binary_entropy(p)) == Approx(0).margin(2e-5));
    CHECK(
        static_cast<double>(binary_cross_entropy(p, 1 - p)) ==
        Approx(-std::log(1e-6)).epsilon(5e-3)  // 1 - 1e-6 is rounded to a multiple of 6e-8
    );
    float g = 0;
    binary_entropy_vjp(p, 1.0f, g);
    binary_cross_entropy_vjp(p, 1 - p, 1.0f, g);
    CHECK(g == 0.0f);
  }
}

TEST_CASE("An image edge's weight is the exponential of its mean contrast") {
  CHECK(edge_weight(Vec3d{0.1, 0.2, 0.3}, Vec3d{0.1, 0.2, 0.3}, 5.0) == 1);
  CHECK(edge_weight(Vec3d{1, 0, 0}, Vec3d{0, 0.5, 0}, 2.0) == Approx(std::exp(-1.0)));
}

TEST_CASE("The normal loss has the gradient of its differences, with and without its L1 part") {
  const Vec3d prior{0.1, 0.7, -0.7};
  for (const double l1 : {0.0, 1.0})
    check_formula(
        [=](Vec3d unit) { return gated_normal_loss(unit, prior, 0.2, l1); },
        [=](Vec3d unit, double g, Vec3d& dL_dunit) {
          gated_normal_loss_vjp(unit, prior, 0.2, l1, g, dL_dunit);
        },
        Vec3d{0.5, 0.3, -0.8}
    );
  CHECK(gated_normal_loss(Vec3d{1, 0, 0}, Vec3d{0, 0, -1}, -2.0, 0.5) == Approx(2));
}
