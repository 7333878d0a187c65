// SPDX-License-Identifier: MIT
// Activation of a cloud and its gradient: the SIMD and the scalar path, every array.
#include "glint/render/shade.h"

#include "glint/core/parallel.h"
#include "glint/render/activations.h"
#include "glint/render/spherical_harmonics.h"
#include "tests/support/check_vjp.h"

using namespace glint;
using namespace glint::test;

namespace {

SurfelCloud random_cloud(std::size_t count) {
  SurfelCloud cloud;
  cloud.extra_names = {"transparency", "specular"};
  cloud.resize(count);
  Rng rng(3);
  cloud.for_each_array([&](const char*, FloatArray& array, std::size_t) {
    for (float& value : array) value = rng.uniform(-1, 1);
  });
  return cloud;
}

// The activated values of one surfel in double, from the shared formulas.
std::vector<double> activate_one(const SurfelCloud& cloud, std::size_t i, Vec3d eye, int degree) {
  const Vec3d mean{cloud.means[3 * i], cloud.means[3 * i + 1], cloud.means[3 * i + 2]};
  double basis[16];
  sh_basis(degree, normalize(mean - eye), basis);
  std::vector<double> values;
  for (int c = 0; c < 3; ++c) {
    double sum = basis[0] * static_cast<double>(cloud.sh_dc[3 * i + c]);
    for (int k = 1; k < sh_coefficients(degree); ++k)
      sum += basis[k] * static_cast<double>(cloud.sh_rest[45 * i + 3 * (k - 1) + c]);
    values.push_back(sh_color(sum));
  }
  for (int e = 0; e < 2; ++e)
    values.push_back(sigmoid(static_cast<double>(cloud.extra_logits[2 * i + e])));
  values.push_back(sigmoid(static_cast<double>(cloud.opacity_logits[i])));
  for (int a = 0; a < 2; ++a)
    values.push_back(std::exp(static_cast<double>(cloud.log_scales[2 * i + a])));
  return values;
}

}  // namespace

TEST_CASE("Activated clouds equal the formulas in double at every degree and lane") {
  const SurfelCloud cloud = random_cloud(21);  // two full groups of eight and five left over
  for (int degree = 0; degree <= 3; ++degree) {
    ActivatedSurfels a;
    activate(cloud, {0.1f, 0.2f, -3}, degree, a);
    REQUIRE(a.channels == 5);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const std::vector<double> expected = activate_one(cloud, i, {0.1f, 0.2f, -3}, degree);
      for (int c = 0; c < 5; ++c)
        CHECK(static_cast<double>(a.features[5 * i + c]) == Approx(expected[c]).margin(2e-6));
      CHECK(static_cast<double>(a.opacities[i]) == Approx(expected[5]).margin(1e-6));
      for (int k = 0; k < 2; ++k)
        CHECK(static_cast<double>(a.scales[2 * i + k]) == Approx(expected[6 + k]).epsilon(1e-6));
    }
  }
}

TEST_CASE("activate_vjp matches central differences of the formulas in double") {
  SurfelCloud cloud = random_cloud(11);
  const Vec3d eye{0.1f, 0.2f, -3};
  ActivatedSurfels a;
  activate(cloud, cast<float>(eye), 3, a);
  RasterGradient g;
  Rng rng(5);
  const auto fill = [&](FloatArray& array, std::size_t size) {
    array.resize(size);
    for (float& value : array) value = rng.uniform(-1, 1);
  };
  fill(g.means, 33), fill(g.scales, 22), fill(g.rotations, 44), fill(g.opacities, 11),
      fill(g.features, 55);
  SurfelCloud gradient;
  gradient.extra_names = cloud.extra_names;
  gradient.resize(cloud.size());
  activate_vjp(cloud, cast<float>(eye), 3, a, g, gradient);

  for (std::size_t i : {std::size_t{0}, std::size_t{7}, std::size_t{10}}) {
    const auto loss = [&] {
      const std::vector<double> v = activate_one(cloud, i, eye, 3);
      double sum = 0;
      for (int c = 0; c < 5; ++c) sum += v[c] * static_cast<double>(g.features[5 * i + c]);
      sum += v[5] * static_cast<double>(g.opacities[i]);
      for (int k = 0; k < 2; ++k) sum += v[6 + k] * static_cast<double>(g.scales[2 * i + k]);
      for (int k = 0; k < 3; ++k)
        sum +=
            static_cast<double>(cloud.means[3 * i + k]) * static_cast<double>(g.means[3 * i + k]);
      for (int k = 0; k < 4; ++k)
        sum += static_cast<double>(cloud.rotations[4 * i + k]) *
               static_cast<double>(g.rotations[4 * i + k]);
      return sum;
    };
    std::vector<FloatArray*> arrays, gradients;
    std::vector<std::size_t> widths;
    cloud.for_each_array([&](const char*, FloatArray& array, std::size_t width) {
      arrays.push_back(&array);
      widths.push_back(width);
    });
    gradient.for_each_array([&](const char*, FloatArray& array, std::size_t) {
      gradients.push_back(&array);
    });
    for (std::size_t k = 0; k < arrays.size(); ++k)
      for (std::size_t j = 0; j < widths[k]; ++j) {
        float& x = (*arrays[k])[i * widths[k] + j];
        const float at = x, h = 1.0f / 256;  // exact in float around these values
        x = at + h;
        const double above = loss();
        const double up = static_cast<double>(x);
        x = at - h;
        const double slope = (above - loss()) / (up - static_cast<double>(x));
        x = at;
        CHECK(
            static_cast<double>((*gradients[k])[i * widths[k] + j]) ==
            Approx(slope).epsilon(1e-3).margin(2e-4)
        );
      }
  }
}
