// SPDX-License-Identifier: MIT
#include "glint/render/transport.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/check_vjp.h"

using namespace glint;
using namespace glint::test;

TEST_CASE("Schlick's term is F0 at normal incidence, 1 at grazing, and F0 from behind") {
  CHECK(schlick(0.04, 1.0) == Approx(0.04));
  CHECK(schlick(0.04, 0.0) == Approx(1.0));
  CHECK(schlick(0.04, -0.5) == Approx(1.0));
  CHECK(schlick(0.04, 0.5) == Approx(0.04 + 0.96 / 32));
}

TEST_CASE("a mirror mirrors: angles are equal, the normal component turns round") {
  const Vec3d n = normalize(Vec3d{0.2, -0.5, -1}), d = normalize(Vec3d{0.3, 0.1, 1});
  const Vec3d w = mirrored_direction(d, n);
  CHECK(length(w) == Approx(1));
  CHECK(dot(w, n) == Approx(-dot(d, n)));
  CHECK(length(cross(w - d, n)) == Approx(0).margin(1e-12));
}

TEST_CASE("the two branches of Eq. 5, 8 and 10 and their sum are one formula") {
  const GlassRadiance<double> p{{0.2, 0.4, 0.6}, {0.9, 0.1, 0.3}, {0.5, 0.7, 0.2}, 0.3, 0.15};
  const Vec3d opaque = 0.85 * p.interface + 0.15 * p.reflection;
  const Vec3d transparent = 0.85 * p.transmission + 0.15 * p.reflection;
  const Vec3d expected = 0.7 * opaque + 0.3 * transparent;
  CHECK(length(outgoing_radiance(p) - expected) == Approx(0).margin(1e-15));
}

TEST_CASE("without transparency and mirroring the interface is all there is, to the bit") {
  const GlassRadiance<float> p{{0.2f, 0.4f, 0.6f}, {0.9f, 0.1f, 0.3f}, {0.5f, 0.7f, 0.2f}, 0, 0};
  const Vec3f out = outgoing_radiance(p);
  for (int c = 0; c < 3; ++c) CHECK(out[c] == p.interface[c]);
}

TEST_CASE("schlick_vjp and mirrored_share_vjp match central differences") {
  check_formula(
      [](double cosine) { return schlick(0.04, cosine); },
      [](double cosine, double g) { return schlick_vjp(0.04, cosine, g); },
      0.4
  );
  CHECK(schlick_vjp(0.04, -0.3, 1.0) == 0.0);
  check_formula(mirrored_share<double>, mirrored_share_vjp<double>, 0.3, 0.2);
}

TEST_CASE("mirrored_direction_vjp matches central differences") {
  const Vec3d d = normalize(Vec3d{0.3, 0.1, 1});
  check_formula(
      [&](Vec3d n) { return mirrored_direction(d, n); },
      [&](Vec3d n, Vec3d g, Vec3d& dL_dn) { mirrored_direction_vjp(d, n, g, dL_dn); },
      Vec3d{0.1, -0.4, -0.9}
  );
}

namespace {

constexpr GlassRadiance<double> kRadiance{
    {0.2, 0.4, 0.6}, {0.9, 0.15, 0.3}, {0.5, 0.7, 0.25}, 0.3, 0.15};

}  // namespace

TEST_CASE("the sRGB curve without a clamp is its inverse's inverse, and goes on beyond [0, 1]") {
  for (const double value : {-0.3, 0.0, 0.02, 0.04, 0.2, 0.5, 1.0, 1.7})
    CHECK(srgb_of_linear(linear_of_srgb(value)) == Approx(value).margin(1e-12));
  CHECK(linear_of_srgb(0.5) == Approx(0.214041).epsilon(1e-5));  // [IEC 61966-2-1]
  CHECK(linear_of_srgb(1.0) == Approx(1));
  for (const double value : {-0.3, 0.02, 0.2, 0.7, 1.3}) {
    check_formula(
        [](double x) { return srgb_of_linear(x); },
        [](double x, double g) { return srgb_of_linear_vjp(x, g); },
        value
    );
    check_formula(
        [](double x) { return linear_of_srgb(x); },
        [](double x, double g) { return linear_of_srgb_vjp(x, g); },
        value
    );
  }
}

TEST_CASE("in linear light a half of white is .735 as displayed, and a sheer pane changes nothing"
) {
  const GlassRadiance<double> half{{0, 0, 0}, {1, 1, 1}, {}, 0.5, 0};
  CHECK(outgoing_displayed(half).x == Approx(0.735357).epsilon(1e-5));
  const GlassRadiance<double> opaque{{0.2, 0.4, 0.9}, {0.9, 0.1, 0.3}, {0.5, 0.7, 0.2}, 0, 0};
  CHECK(length(outgoing_displayed(opaque) - opaque.interface) == Approx(0).margin(1e-12));
}

TEST_CASE("parts of a displayed value are in the ratio of their light and add up to it") {
  const GlassRadiance<double> p{{0.2, 0.4, 0.6}, {0.9, 0.1, 0.3}, {0.5, 0.7, 0.2}, 0.3, 0.15};
  const double picture = outgoing_displayed(p).y;
  const double opaque = displayed_part(picture, p.interface.y, 0.85 * 0.7);
  const double through = displayed_part(picture, p.transmission.y, 0.85 * 0.3);
  const double mirrored = displayed_part(picture, p.reflection.y, 0.15);
  CHECK(opaque + through + mirrored == Approx(picture));
  CHECK(
      through / mirrored == Approx(0.85 * 0.3 * linear_of_srgb(0.1) / (0.15 * linear_of_srgb(0.7)))
  );
  CHECK(displayed_part(0.0, 0.0, 0.5) == 0.0);
}

TEST_CASE("outgoing_displayed_vjp matches central differences") {
  check_formula(outgoing_displayed<double>, outgoing_displayed_vjp<double>, kRadiance);
}

TEST_CASE("outgoing_radiance_vjp matches central differences") {
  check_formula(outgoing_radiance<double>, outgoing_radiance_vjp<double>, kRadiance);
}
