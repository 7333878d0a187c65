// SPDX-License-Identifier: MIT
// Every _vjp of the shared maths against central differences in double.
#include "glint/render/depth_normal.h"
#include "glint/render/project.h"
#include "glint/render/spherical_harmonics.h"
#include "tests/support/check_vjp.h"

using namespace glint;
using namespace glint::test;

namespace {

PlaneMap<double> unpack_map(const Vector& x, std::size_t i) {
  return {vec3(x, i), vec3(x, i + 3), vec3(x, i + 6), x[i + 9]};
}
void push_map(Vector& x, const PlaneMap<double>& map) {
  for (const Vec3d& e : {map.e1, map.e2, map.e3}) push(x, e);
  x.push_back(map.det);
}

SurfelGeometry<double> unpack_surfel(const Vector& x) {
  return {vec3(x, 0), {x[3], x[4]}, {x[5], x[6], x[7], x[8]}};
}
Vector pack(const SurfelGeometry<double>& s) {
  const Vec4<double> q = s.rotation;
  return {s.mean.x, s.mean.y, s.mean.z, s.scale.x, s.scale.y, q.w, q.x, q.y, q.z};
}
// A surfel in front of a rotated camera with an off-centre principal point.
const Vector kSurfel = {0.2, -0.1, 4, 0.3, 0.15, 0.9, 0.2, -0.3, 0.1};
CameraOf<double> test_camera() {
  const Mat3d rotation = rotation_matrix(Vec4<double>{0.95, 0.1, -0.2, 0.05});
  return {rotation, {0.1, -0.2, 0.3}, 500, 480, 310, 250, 640, 480, 0.2};
}

}  // namespace

TEST_CASE("plane_map_vjp matches central differences") {
  check_vjp(
      random_inputs(9, -1, 1, 1),
      [](const Vector& x) {
        Vector y;
        push_map(y, plane_map(vec3(x, 0), vec3(x, 3), vec3(x, 6)));
        return y;
      },
      [](const Vector& x, const Vector& g) {
        Vec3d h0{}, h1{}, m{};
        plane_map_vjp(vec3(x, 0), vec3(x, 3), vec3(x, 6), unpack_map(g, 0), h0, h1, m);
        Vector y;
        for (const Vec3d& v : {h0, h1, m}) push(y, v);
        return y;
      }
  );
}

TEST_CASE("intersect_vjp matches central differences") {
  check_vjp(
      {0.3, -0.4, 1.2, 2.5},
      [](const Vector& x) {
        const PlaneHit<double> hit = intersect(vec3(x, 0), x[3]);
        return Vector{hit.u, hit.v, hit.t};
      },
      [](const Vector& x, const Vector& g) {
        Vec3d zeta{};
        double det = 0;
        intersect_vjp(intersect(vec3(x, 0), x[3]), g[0], g[1], g[2], zeta, det);
        return Vector{zeta.x, zeta.y, zeta.z, det};
      }
  );
}

TEST_CASE("low_pass_rho2_vjp matches central differences") {
  check_vjp(
      {0.3, -0.7},
      [](const Vector& x) { return Vector{low_pass_rho2(x[0], x[1])}; },
      [](const Vector& x, const Vector& g) {
        Vector y(2);
        low_pass_rho2_vjp(x[0], x[1], g[0], y[0], y[1]);
        return y;
      }
  );
}

TEST_CASE("splat_alpha_vjp matches central differences and is zero where alpha is clamped") {
  const auto vjp = [](const Vector& x, const Vector& g) {
    Vector y(2);
    splat_alpha_vjp(x[0], splat_alpha(x[0], x[1]), g[0], y[0], y[1]);
    return y;
  };
  check_vjp(
      {0.7, 1.3}, [](const Vector& x) { return Vector{splat_alpha(x[0], x[1]).alpha}; }, vjp
  );
  CHECK(vjp({1.0, 0.001}, {1.0}) == Vector{0, 0});
}

TEST_CASE("blend_alpha_vjp gives the gradient of front-to-back compositing") {
  // Four hits with alphas x[0..4) and values x[4..8): F = sum w f.
  const auto composite = [](const Vector& x) {
    double t = 1, f = 0;
    for (int i = 0; i < 4; ++i) {
      const BlendStep<double> step = blend_step(t, x[i]);
      f += step.weight * x[4 + i];
      t = step.transmittance;
    }
    return Vector{f};
  };
  check_vjp(
      {0.3, 0.6, 0.2, 0.8, 1.5, -0.4, 0.7, 2.0},
      composite,
      [&](const Vector& x, const Vector& g) {
        Vector y(8);
        double t = 1, remaining = composite(x)[0] * g[0];
        for (int i = 0; i < 4; ++i) {
          const BlendStep<double> step = blend_step(t, x[i]);
          remaining -= step.weight * x[4 + i] * g[0];
          y[i] = blend_alpha_vjp(t, x[i], x[4 + i] * g[0], remaining);
          y[4 + i] = step.weight * g[0];
          t = step.transmittance;
        }
        return y;
      }
  );
}

TEST_CASE("distortion is the pairwise sum, and its derivatives match central differences") {
  // Three hits: weights x[0..3), mapped depths x[3..6).
  const auto pairwise = [](const Vector& x) {
    double sum = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < i; ++j) sum += x[i] * x[j] * square(x[3 + i] - x[3 + j]);
    return Vector{sum};
  };
  const auto moments = [](const Vector& x) {
    Vec3d m{};
    for (int i = 0; i < 3; ++i) m += x[i] * Vec3d{1, x[3 + i], x[3 + i] * x[3 + i]};
    return m;
  };
  const Vector x = {0.5, 0.2, 0.3, 0.1, 0.6, 0.9};
  const Vec3d m = moments(x);
  CHECK(distortion(m.x, m.y, m.z) == Approx(pairwise(x)[0]).epsilon(1e-12));
  check_vjp(x, pairwise, [&](const Vector& in, const Vector& g) {
    const Vec3d t = moments(in);
    Vector y(6);
    for (int i = 0; i < 3; ++i) {
      y[i] = g[0] * distortion_dweight(in[3 + i], t.x, t.y, t.z);
      y[3 + i] = g[0] * distortion_dm(in[i], in[3 + i], t.x, t.y);
    }
    return y;
  });
}

TEST_CASE("distortion_depth_vjp and expected_depth_vjp match central differences") {
  check_vjp(
      {2.5},
      [](const Vector& x) { return Vector{distortion_depth(x[0], 3.0, 0.2, 100.0)}; },
      [](const Vector& x, const Vector& g) {
        return Vector{distortion_depth_vjp(x[0], 0.2, 100.0, g[0])};
      }
  );
  check_vjp(
      {2.5, 0.8},
      [](const Vector& x) { return Vector{expected_depth(x[0], x[1])}; },
      [](const Vector& x, const Vector& g) {
        Vector y(2);
        expected_depth_vjp(x[0], x[1], g[0], y[0], y[1]);
        return y;
      }
  );
}

TEST_CASE("activation vjps match central differences") {
  check_vjp(
      {0.4},
      [](const Vector& x) { return Vector{sigmoid(x[0])}; },
      [](const Vector& x, const Vector& g) { return Vector{sigmoid_vjp(sigmoid(x[0]), g[0])}; }
  );
  check_vjp(
      {-1.4},
      [](const Vector& x) { return Vector{exp_fast(x[0])}; },
      [](const Vector& x, const Vector& g) { return Vector{exp_vjp(exp_fast(x[0]), g[0])}; }
  );
  check_vjp(
      {0.9, 0.2, -0.3, 0.1},
      [](const Vector& x) {
        const Mat3d r = rotation_matrix(Vec4<double>{x[0], x[1], x[2], x[3]});
        Vector y;
        for (const Vec3d& row : r.rows) push(y, row);
        return y;
      },
      [](const Vector& x, const Vector& g) {
        Vec4<double> q{};
        const Mat3d dL_dr{{vec3(g, 0), vec3(g, 3), vec3(g, 6)}};
        rotation_matrix_vjp(Vec4<double>{x[0], x[1], x[2], x[3]}, dL_dr, q);
        return Vector{q.w, q.x, q.y, q.z};
      }
  );
}

TEST_CASE("surfel_in_cam_vjp matches central differences") {
  const CameraOf<double> camera = test_camera();
  check_vjp(
      kSurfel,
      [&](const Vector& x) {
        const SurfelInCam<double> s = surfel_in_cam(unpack_surfel(x), camera);
        Vector y;
        for (const Vec3d& v : {s.h0, s.h1, s.m, s.normal}) push(y, v);
        return y;
      },
      [&](const Vector& x, const Vector& g) {
        const SurfelGeometry<double> surfel = unpack_surfel(x);
        const SurfelInCam<double> dL{vec3(g, 0), vec3(g, 3), vec3(g, 6), vec3(g, 9), 0};
        SurfelGeometry<double> out{};
        surfel_in_cam_vjp(surfel, camera, surfel_in_cam(surfel, camera).facing, dL, out);
        return pack(out);
      }
  );
}

TEST_CASE("project_surfel_vjp matches central differences of zeta at a pixel, centre, depth, normal"
) {
  const CameraOf<double> camera = test_camera();
  // The reference point moves with the surfel, so outputs are compared at a fixed image point.
  const double px = 330.5, py = 260.5;
  check_vjp(
      kSurfel,
      [&](const Vector& x) {
        const ProjectedSurfel<double> p = project_surfel(unpack_surfel(x), camera, 9.0);
        Vector y;
        push(y, zeta_at(p.map, px - p.x_ref, py - p.y_ref));
        y.insert(y.end(), {p.map.det, p.center_x + p.x_ref, p.center_y + p.y_ref, p.z_center});
        push(y, p.normal);
        y.push_back(p.plane_distance);
        return y;
      },
      [&](const Vector& x, const Vector& g) {
        const SurfelGeometry<double> surfel = unpack_surfel(x);
        const ProjectedSurfel<double> p = project_surfel(surfel, camera, 9.0);
        ProjectedSurfel<double> dL{};
        dL.map.g0 = vec3(g, 0);
        dL.map.gx = (px - p.x_ref) * vec3(g, 0);
        dL.map.gy = (py - p.y_ref) * vec3(g, 0);
        dL.map.det = g[3];
        dL.center_x = g[4];
        dL.center_y = g[5];
        dL.z_center = g[6];
        dL.normal = vec3(g, 7);
        dL.plane_distance = g[10];
        SurfelGeometry<double> out{};
        Vec3d dL_dm;
        project_surfel_vjp(surfel, camera, dL, true, out, dL_dm);
        return pack(out);
      }
  );
}

TEST_CASE("the screen statistic is of hits within the disc, and of the low-pass if asked for") {
  const CameraOf<double> camera = test_camera();
  const SurfelGeometry<double> surfel = unpack_surfel(kSurfel);
  // dL/d(centre in camera space), as the statistic has it and as the parameter has it.
  const auto of = [&](const ProjectedSurfel<double>& dL, bool low_pass) {
    SurfelGeometry<double> gradient{};
    Vec3d dL_dm;
    project_surfel_vjp(surfel, camera, dL, low_pass, gradient, dL_dm);
    return std::pair(dL_dm, camera.rotation * gradient.mean);
  };
  const auto check_same = [](const std::pair<Vec3d, Vec3d>& found) {
    CHECK(length(found.second) > 1e-3);
    CHECK(length(found.first - found.second) < 1e-9 * length(found.second));
  };
  ProjectedSurfel<double> disc{}, low_pass{}, plane{};
  disc.map.g0 = {0.3, -0.2, 0.1};
  disc.map.det = 0.7;
  low_pass.center_x = 0.4, low_pass.center_y = -0.6;
  plane.plane_distance = 1;
  for (const bool counts : {false, true}) {
    check_same(of(disc, counts));
    const auto [statistic, parameter] = of(plane, counts);
    CHECK(length(statistic) == 0);
    CHECK(length(parameter) > 0.5);
  }
  check_same(of(low_pass, true));
  CHECK(length(of(low_pass, false).first) == 0);
}

TEST_CASE("sh_basis_vjp matches central differences at every degree") {
  for (int degree = 1; degree <= 3; ++degree)
    check_vjp(
        {0.3, -0.5, 0.81},
        [&](const Vector& x) {
          Vector y(16);
          sh_basis(degree, vec3(x, 0), y.data());
          y.resize(sh_coefficients(degree));
          return y;
        },
        [&](const Vector& x, const Vector& g) {
          Vec3d d{};
          sh_basis_vjp(degree, vec3(x, 0), g.data(), d);
          return Vector{d.x, d.y, d.z};
        }
    );
}

TEST_CASE("sh_color_vjp is zero where negative light is clamped") {
  CHECK(sh_color(0.2) == Approx(0.7));
  CHECK(sh_color_vjp(0.2, 3.0) == 3.0);
  CHECK(sh_color(-0.6) == 0.0);
  CHECK(sh_color_vjp(-0.6, 3.0) == 0.0);
}

TEST_CASE("spherical harmonics are orthonormal over the sphere") {
  // Product rule: Gauss-Legendre in z is exact for these polynomials with 4 nodes, 8 azimuths.
  const double nodes[4] = {
      -0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
  const double weights[4] = {
      0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
  double gram[16][16] = {};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 8; ++j) {
      const double phi = 2 * 3.141592653589793 * j / 8, r = std::sqrt(1 - nodes[i] * nodes[i]);
      double basis[16];
      sh_basis(3, Vec3d{r * std::cos(phi), r * std::sin(phi), nodes[i]}, basis);
      for (int a = 0; a < 16; ++a)
        for (int b = 0; b < 16; ++b)
          gram[a][b] += weights[i] * (2 * 3.141592653589793 / 8) * basis[a] * basis[b];
    }
  for (int a = 0; a < 16; ++a)
    for (int b = 0; b < 16; ++b) CHECK(gram[a][b] == Approx(a == b ? 1.0 : 0.0).margin(2e-7));
}

TEST_CASE("normal_from_differences faces the camera and its vjp matches central differences") {
  const Vec3d n = normal_from_differences(Vec3d{0.2, 0, 0}, Vec3d{0, 0.2, 0});
  CHECK(n.z == Approx(-1.0));
  check_vjp(
      random_inputs(6, -1, 1, 5),
      [](const Vector& x) {
        Vector y;
        push(y, normal_from_differences(vec3(x, 0), vec3(x, 3)));
        return y;
      },
      [](const Vector& x, const Vector& g) {
        Vec3d dx{}, dy{};
        normal_from_differences_vjp(vec3(x, 0), vec3(x, 3), vec3(g, 0), dx, dy);
        Vector y;
        push(y, dx);
        push(y, dy);
        return y;
      }
  );
}
