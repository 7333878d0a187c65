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

TEST_CASE("the two branches of Eq. 5-7 and their sum are one formula") {
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
  check_vjp(
      {0.4},
      [](const Vector& x) { return Vector{schlick(0.04, x[0])}; },
      [](const Vector& x, const Vector& g) { return Vector{schlick_vjp(0.04, x[0], g[0])}; }
  );
  CHECK(schlick_vjp(0.04, -0.3, 1.0) == 0.0);
  check_vjp(
      {0.3, 0.2},
      [](const Vector& x) { return Vector{mirrored_share(x[0], x[1])}; },
      [](const Vector& x, const Vector& g) {
        Vector y(2);
        mirrored_share_vjp(x[0], x[1], g[0], y[0], y[1]);
        return y;
      }
  );
}

TEST_CASE("mirrored_direction_vjp matches central differences") {
  const Vec3d d = normalize(Vec3d{0.3, 0.1, 1});
  check_vjp(
      {0.1, -0.4, -0.9},
      [&](const Vector& x) {
        Vector y;
        push(y, mirrored_direction(d, vec3(x, 0)));
        return y;
      },
      [&](const Vector& x, const Vector& g) {
        Vec3d dL_dn{};
        mirrored_direction_vjp(d, vec3(x, 0), vec3(g, 0), dL_dn);
        return Vector{dL_dn.x, dL_dn.y, dL_dn.z};
      }
  );
}

TEST_CASE("outgoing_radiance_vjp matches central differences") {
  const auto unpack = [](const Vector& x) {
    return GlassRadiance<double>{vec3(x, 0), vec3(x, 3), vec3(x, 6), x[9], x[10]};
  };
  check_vjp(
      random_inputs(11, 0, 1, 3),
      [&](const Vector& x) {
        Vector y;
        push(y, outgoing_radiance(unpack(x)));
        return y;
      },
      [&](const Vector& x, const Vector& g) {
        const GlassRadiance<double> r = outgoing_radiance_vjp(unpack(x), vec3(g, 0));
        Vector y;
        for (const Vec3d& v : {r.interface, r.transmission, r.reflection}) push(y, v);
        y.push_back(r.transparency);
        y.push_back(r.mirrored);
        return y;
      }
  );
}
