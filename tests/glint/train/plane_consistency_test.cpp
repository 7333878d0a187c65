// SPDX-License-Identifier: MIT
#include "glint/train/plane_consistency.h"

#include "glint/train/normal_consistency.h"
#include "tests/support/two_views.h"

using namespace glint;
using namespace glint::test;

namespace {

// The formula in double, pixel by pixel.
double brute_force(
    const Camera& camera,
    const ImageD& normal,
    const ImageD& depth,
    const Image& alpha,
    const Image& flatness
) {
  double sum = 0;
  const auto point = [&](int x, int y) {
    return depth.at(x, y) * camera.ray_in_cam(x + 0.5, y + 0.5);
  };
  for (int y = 1; y + 1 < depth.height(); ++y)
    for (int x = 1; x + 1 < depth.width(); ++x) {
      const Vec3d n =
          normalize(cross(point(x, y + 1) - point(x, y - 1), point(x + 1, y) - point(x - 1, y)));
      for (int c = 0; c < 3; ++c)
        sum += static_cast<double>(flatness.at(x, y)) *
               std::abs(static_cast<double>(alpha.at(x, y)) * n[c] - normal.at(x, y, c));
    }
  return sum / static_cast<double>(depth.num_pixels());
}

struct Inputs {
  TwoViews views{{11, 9}};
  ImageSize size = views.reference.size();
  Image depth = with_noise(views.depth<float>(false), 0.2, 3);
  Image normal = random_map<float>(size, 3, -1, 1, 4);
  Image alpha = random_map<float>(size, 1, 0.5f, 1, 5);
  Image flatness = random_map<float>(size, 1, 0.1f, 1, 6);
};

}  // namespace

TEST_CASE("The loss and its gradients are the formula's") {
  const Inputs in;
  const Camera& camera = in.views.reference;
  const float weight = 0.5f;
  Image dL_dn(in.size.width, in.size.height, 3), dL_dz(in.size.width, in.size.height, 1);
  const double loss = PlaneConsistencyLoss().evaluate(
      camera, in.normal, in.depth, in.alpha, in.flatness, weight, dL_dn, dL_dz
  );
  const ImageD normal = in_double(in.normal), depth = in_double(in.depth);
  CHECK(loss == Approx(brute_force(camera, normal, depth, in.alpha, in.flatness)).epsilon(1e-5));
  const auto of = [&](const std::vector<ImageD>& maps) {
    return static_cast<double>(weight) *
           brute_force(camera, maps[0], maps[1], in.alpha, in.flatness);
  };
  const GradientError error =
      gradient_error_of(of, {normal, depth}, {in_double(dL_dn), in_double(dL_dz)});
  INFO("largest difference at " << error.worst_index);
  REQUIRE(error.norm > 0);
  CHECK(error.distance < 2e-4 * error.norm);  // float
}

TEST_CASE("A plane whose normals agree has no loss, and edges of the photo count less") {
  Inputs in;
  const TwoViews& views = in.views;
  Image distance, dL_dn(in.size.width, in.size.height, 3);
  Image dL_dz(in.size.width, in.size.height, 1);
  views.planes(in.normal, distance);
  for (std::size_t i = 0; i < in.alpha.num_pixels(); ++i)  // coverage, as planes() drew it
    in.alpha.data()[i] = distance.data()[i] / static_cast<float>(views.distance);
  const auto loss = [&](const Image& normal, const Image& flatness) {
    return PlaneConsistencyLoss().evaluate(
        views.reference, normal, views.depth<float>(false), in.alpha, flatness, 1, dL_dn, dL_dz
    );
  };
  CHECK(loss(in.normal, in.flatness) < 1e-5);
  const Image off = with_noise(in.normal, 0.3, 8);
  const Image half(in.size.width, in.size.height, 1, 0.5f);
  const Image all(in.size.width, in.size.height, 1, 1.0f);
  CHECK(loss(off, half) == Approx(0.5 * loss(off, all)));
}

TEST_CASE("The weight is 1 where the photo is flattest, 0 at its strongest edge and the border") {
  Image rgb(9, 7, 3, 0.25f);
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 9; ++x)
      for (int c = 0; c < 3; ++c) {
        if (x > 2) rgb.at(x, y, c) = 0.45f;  // a weak edge, differences of 0.2 at 2 and 3
        if (x > 5) rgb.at(x, y, c) = 0.95f;  // a strong one, 0.5 at 5 and 6
      }
  const Image weight = flatness_weight(rgb);
  for (int y = 1; y < 6; ++y) {
    CHECK(weight.at(1, y) == Approx(1));
    CHECK(weight.at(2, y) == Approx(0.36));  // (1 - 0.2 / 0.5)^2
    CHECK(weight.at(4, y) == Approx(1));
    CHECK(weight.at(5, y) == Approx(0).margin(1e-6));
  }
  CHECK(weight.at(0, 3) == 0.0f);
  CHECK(weight.at(4, 6) == 0.0f);
  CHECK(flatness_weight(Image(5, 5, 3, 0.3f)).at(2, 2) == 1.0f);
}
