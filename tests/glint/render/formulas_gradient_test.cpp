// SPDX-License-Identifier: MIT
// Every _vjp of the shared maths against central differences in double.
#include "glint/render/depth_normal.h"
#include "glint/render/project.h"
#include "glint/render/spherical_harmonics.h"
#include "tests/support/check_vjp.h"

using namespace glint;
using namespace glint::test;

namespace {

// A surfel in front of a rotated camera with an off-centre principal point.
const SurfelGeometry<double> kSurfel = {{0.2, -0.1, 4}, {0.3, 0.15}, {0.9, 0.2, -0.3, 0.1}};
CameraOf<double> test_camera() {
  const Mat3d rotation = rotation_matrix(Vec4<double>{0.95, 0.1, -0.2, 0.05});
  return {rotation, {0.1, -0.2, 0.3}, 500, 480, 310, 250, 640, 480, 0.2};
}

}  // namespace

TEST_CASE("plane_map_vjp matches central differences") {
  check_formula(
      plane_map<double>,
      plane_map_vjp<double>,
      Vec3d{0.9, -0.4, 0.2},
      Vec3d{-0.3, 0.7, -0.6},
      Vec3d{0.1, 0.5, -0.8}
  );
}

TEST_CASE("intersect_vjp matches central differences") {
  check_formula(
      [](Vec3d zeta, double det) {
        const PlaneHit<double> hit = intersect(zeta, det);
        return Vec3d{hit.u, hit.v, hit.t};
      },
      [](Vec3d zeta, double det, Vec3d g, Vec3d& dL_dzeta, double& dL_ddet) {
        intersect_vjp(intersect(zeta, det), g.x, g.y, g.z, dL_dzeta, dL_ddet);
      },
      Vec3d{0.3, -0.4, 1.2},
      2.5
  );
}

TEST_CASE("low_pass_rho2_vjp matches central differences") {
  check_formula(low_pass_rho2<double>, low_pass_rho2_vjp<double>, 0.3, -0.7);
}

TEST_CASE("splat_alpha_vjp matches central differences and is zero where alpha is clamped") {
  const auto vjp = [](double opacity, double rho, double g, double& dL_dopacity, double& dL_drho) {
    splat_alpha_vjp(opacity, splat_alpha(opacity, rho), g, dL_dopacity, dL_drho);
  };
  check_formula([](double o, double rho) { return splat_alpha(o, rho).alpha; }, vjp, 0.7, 1.3);
  Vec2d clamped{};
  vjp(1.0, 0.001, 1.0, clamped.x, clamped.y);
  CHECK((clamped.x == 0 && clamped.y == 0));
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
  check_formula(
      [](double z) { return distortion_depth(z, 3.0, 0.2, 100.0); },
      [](double z, double g) { return distortion_depth_vjp(z, 0.2, 100.0, g); },
      2.5
  );
  check_formula(expected_depth<double>, expected_depth_vjp<double>, 2.5, 0.8);
}

TEST_CASE("activation vjps match central differences") {
  check_formula(
      [](double x) { return sigmoid(x); },
      [](double x, double g) { return sigmoid_vjp(sigmoid(x), g); },
      0.4
  );
  check_formula(
      [](double x) { return exp_fast(x); },
      [](double x, double g) { return exp_vjp(exp_fast(x), g); },
      -1.4
  );
  check_formula(
      rotation_matrix<double>, rotation_matrix_vjp<double>, Vec4<double>{0.9, 0.2, -0.3, 0.1}
  );
}

TEST_CASE("surfel_in_cam_vjp matches central differences") {
  struct Outputs {
    Vec3d h0, h1, m, normal;
  };
  check_formula(
      [](const SurfelGeometry<double>& surfel) {
        const SurfelInCam<double> s = surfel_in_cam(surfel, test_camera());
        return Outputs{s.h0, s.h1, s.m, s.normal};
      },
      [](const SurfelGeometry<double>& surfel, Outputs g, SurfelGeometry<double>& dL_dsurfel) {
        const double facing = surfel_in_cam(surfel, test_camera()).facing;
        surfel_in_cam_vjp(
            surfel, test_camera(), facing, {g.h0, g.h1, g.m, g.normal, 0}, dL_dsurfel
        );
      },
      kSurfel
  );
}

TEST_CASE("project_surfel_vjp matches central differences of zeta at a pixel, centre, depth, normal"
) {
  // The reference point moves with the surfel, so outputs are compared at a fixed image point.
  struct Outputs {
    Vec3d zeta;
    double det, center_x, center_y, z_center;
    Vec3d normal;
    double plane_distance;
  };
  const double px = 330.5, py = 260.5;
  check_formula(
      [&](const SurfelGeometry<double>& surfel) {
        const ProjectedSurfel<double> p = project_surfel(surfel, test_camera(), 9.0);
        return Outputs{
            zeta_at(p.map, px - p.x_ref, py - p.y_ref),
            p.map.det,
            p.center_x + p.x_ref,
            p.center_y + p.y_ref,
            p.z_center,
            p.normal,
            p.plane_distance};
      },
      [&](const SurfelGeometry<double>& surfel, Outputs g, SurfelGeometry<double>& dL_dsurfel) {
        const ProjectedSurfel<double> p = project_surfel(surfel, test_camera(), 9.0);
        ProjectedSurfel<double> dL{};
        dL.map.g0 = g.zeta;
        dL.map.gx = (px - p.x_ref) * g.zeta;
        dL.map.gy = (py - p.y_ref) * g.zeta;
        dL.map.det = g.det;
        dL.center_x = g.center_x;
        dL.center_y = g.center_y;
        dL.z_center = g.z_center;
        dL.normal = g.normal;
        dL.plane_distance = g.plane_distance;
        Vec3d dL_dm;
        project_surfel_vjp(surfel, test_camera(), dL, true, dL_dsurfel, dL_dm);
      },
      kSurfel
  );
}

TEST_CASE("the screen statistic is of hits within the disc, and of the low-pass if asked for") {
  const CameraOf<double> camera = test_camera();
  // dL/d(centre in camera space), as the statistic has it and as the parameter has it.
  const auto of = [&](const ProjectedSurfel<double>& dL, bool low_pass) {
    SurfelGeometry<double> gradient{};
    Vec3d dL_dm;
    project_surfel_vjp(kSurfel, camera, dL, low_pass, gradient, dL_dm);
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
  check_formula(
      normal_from_differences<double>,
      normal_from_differences_vjp<double>,
      Vec3d{0.9, -0.2, 0.4},
      Vec3d{-0.3, 0.6, 0.7}
  );
}
