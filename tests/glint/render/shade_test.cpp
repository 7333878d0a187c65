// SPDX-License-Identifier: MIT
// Activation of a cloud and its gradient: the SIMD and the scalar path, every array.
#include "glint/render/shade.h"

#include "glint/core/parallel.h"
#include "glint/render/activations.h"
#include "glint/render/spherical_harmonics.h"
#include "tests/support/check_vjp.h"
#include "tests/support/random_values.h"

using namespace glint;
using namespace glint::test;

namespace {

const std::vector<std::string> kExtras = {"transparency", "specular"};

double extra_in_double(const SurfelCloud& cloud, std::size_t i, std::size_t e) {
  const auto x = static_cast<double>(cloud.extra_logits[2 * i + e]);
  const Activation kind =
      cloud.extra_activations.empty() ? Activation::kSigmoid : cloud.extra_activations[e];
  if (kind == Activation::kTanh) return std::tanh(x);
  return kind == Activation::kCappedExp ? std::exp(std::min(x, 5.0)) / 5 : 1 / (1 + std::exp(-x));
}

// The activated values of one surfel in double, from the shared formulas. Extra channels that are
// not shown count as 0.
std::vector<double> activate_one(
    const SurfelCloud& cloud,
    std::size_t i,
    Vec3d eye,
    int degree,
    const ActivationOptions& options = {}
) {
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
  for (std::size_t e = 0; e < 2; ++e)
    values.push_back(options.color_only ? 0.0 : extra_in_double(cloud, i, e));
  values.push_back(sigmoid(static_cast<double>(cloud.opacity_logits[i])));
  for (std::size_t c = 0; c < 3 && options.color_offsets != nullptr; ++c)
    values[c] += static_cast<double>((*options.color_offsets)[3 * i + c]);
  if (options.opacity_factor >= 0)
    values.back() *= extra_in_double(cloud, i, static_cast<std::size_t>(options.opacity_factor));
  for (int a = 0; a < 2; ++a)
    values.push_back(std::exp(static_cast<double>(cloud.log_scales[2 * i + a])));
  return values;
}

}  // namespace

TEST_CASE("Activated clouds equal the formulas in double at every degree and lane") {
  const SurfelCloud cloud =
      random_cloud(21, kExtras);  // two full groups of eight and five left over
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

namespace {

RasterGradient random_gradient(std::size_t count, std::size_t channels) {
  RasterGradient g;
  Rng rng(5);
  const auto fill = [&](const char*, std::size_t width, FloatArray& array) {
    array.resize(width * count);
    for (float& value : array) value = rng.uniform(-1, 1);
  };
  RasterGradient::for_each_array({.features = static_cast<int>(channels)}, fill, g);
  return g;
}

// What surfel i's activated values are worth to a loss with this gradient, in double.
double loss_of(
    const SurfelCloud& cloud,
    std::size_t i,
    Vec3d eye,
    const ActivationOptions& options,
    const RasterGradient& g
) {
  const std::vector<double> v = activate_one(cloud, i, eye, 3, options);
  double sum = 0;
  const auto add = [&](double value, const FloatArray& gradient, std::size_t at) {
    sum += value * static_cast<double>(gradient[at]);
  };
  const std::size_t channels = options.color_only ? 3 : 5;
  for (std::size_t c = 0; c < channels; ++c) add(v[c], g.features, i * channels + c);
  add(v[5], g.opacities, i);
  for (std::size_t k = 0; k < 2; ++k) add(v[6 + k], g.scales, 2 * i + k);
  for (std::size_t k = 0; k < 3; ++k)
    add(static_cast<double>(cloud.means[3 * i + k]), g.means, 3 * i + k);
  for (std::size_t k = 0; k < 4; ++k)
    add(static_cast<double>(cloud.rotations[4 * i + k]), g.rotations, 4 * i + k);
  return sum;
}

void check_activate_vjp(SurfelCloud cloud, const ActivationOptions& options) {
  const Vec3d eye{0.1f, 0.2f, -3};
  ActivatedSurfels a;
  a.options = options;
  activate(cloud, cast<float>(eye), 3, a);
  const RasterGradient g = random_gradient(cloud.size(), options.color_only ? 3 : 5);
  SurfelCloud gradient;
  gradient.extra_names = cloud.extra_names;
  gradient.resize(cloud.size());
  activate_vjp(cloud, cast<float>(eye), 3, a, g, gradient);

  std::vector<FloatArray*> gradients;
  gradient.for_each_array([&](const char*, FloatArray& array, std::size_t) {
    gradients.push_back(&array);
  });
  std::size_t next = 0;
  cloud.for_each_array([&](const char* name, FloatArray& array, std::size_t width) {
    const FloatArray& actual = *gradients[next++];
    for (const std::size_t i : {0, 7, 10})
      for (std::size_t j = i * width; j < (i + 1) * width; ++j) {
        const float at = array[j], h = 1.0f / 256;  // exact in float around these values
        const auto loss = [&](float x) {
          array[j] = x;
          return loss_of(cloud, i, eye, options, g);
        };
        const double slope = (loss(at + h) - loss(at - h)) /
                             (static_cast<double>(at + h) - static_cast<double>(at - h));
        array[j] = at;
        INFO(name << " " << j);
        CHECK(static_cast<double>(actual[j]) == Approx(slope).epsilon(1e-3).margin(2e-4));
      }
  });
}

}  // namespace

TEST_CASE("activate_vjp matches central differences of the formulas in double") {
  check_activate_vjp(random_cloud(11, kExtras), {});
}

TEST_CASE("Other activations and passes have their gradients, too") {
  SurfelCloud cloud = random_cloud(11, kExtras);
  cloud.extra_activations = {Activation::kTanh, Activation::kCappedExp};
  for (float& x : cloud.extra_logits) x *= 2;
  check_activate_vjp(cloud, {});
  check_activate_vjp(cloud, {.opacity_factor = 1});
  cloud.extra_logits[1] = 7;  // capped
  check_activate_vjp(cloud, {});
  cloud.extra_activations = {Activation::kTanh, Activation::kSigmoid};
  check_activate_vjp(cloud, {.opacity_factor = 1, .color_only = true});
  check_activate_vjp(cloud, {.color_only = true});
}

TEST_CASE("Activated clouds have other activations, opacity factors and channels in all lanes") {
  SurfelCloud cloud = random_cloud(21, kExtras);
  cloud.extra_activations = {Activation::kTanh, Activation::kCappedExp};
  for (float& x : cloud.extra_logits) x *= 6;  // beyond the cap
  for (const ActivationOptions& options :
       {ActivationOptions{.opacity_factor = 1}, ActivationOptions{.color_only = true}}) {
    ActivatedSurfels a;
    a.options = options;
    activate(cloud, {0.1f, 0.2f, -3}, 2, a);
    REQUIRE(a.channels == (options.color_only ? 3 : 5));
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const std::vector<double> expected = activate_one(cloud, i, {0.1f, 0.2f, -3}, 2, options);
      for (int c = 0; c < a.channels; ++c)
        CHECK(
            static_cast<double>(a.features[i * static_cast<std::size_t>(a.channels) + c]) ==
            Approx(expected[c]).epsilon(1e-5).margin(2e-6)
        );
      CHECK(static_cast<double>(a.opacities[i]) == Approx(expected[5]).epsilon(1e-5));
    }
  }
}

TEST_CASE("Offsets of colours are added behind the clamp, and hide no gradient and add none") {
  SurfelCloud cloud = random_cloud(11, kExtras);
  for (std::size_t c = 0; c < 3; ++c) cloud.sh_dc[3 * 7 + c] = -9;  // clamped
  FloatArray offsets(33);
  Rng rng(8);
  for (float& value : offsets) value = rng.uniform(-1, 1);
  ActivatedSurfels a;
  a.options.color_offsets = &offsets;
  activate(cloud, {0.1f, 0.2f, -3}, 3, a);
  for (std::size_t c = 0; c < 3; ++c) CHECK(a.features[5 * 7 + c] == offsets[3 * 7 + c]);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::vector<double> expected = activate_one(cloud, i, {0.1f, 0.2f, -3}, 3, a.options);
    for (std::size_t c = 0; c < 5; ++c)
      CHECK(static_cast<double>(a.features[5 * i + c]) == Approx(expected[c]).margin(2e-6));
  }
  check_activate_vjp(cloud, a.options);
  const RasterGradient g = random_gradient(11, 5);
  FloatArray dL_dcolors;
  color_gradient(g, 5, dL_dcolors);
  REQUIRE(dL_dcolors.size() == 33);
  for (std::size_t i = 0; i < 33; ++i) CHECK(dL_dcolors[i] == g.features[i / 3 * 5 + i % 3]);
}

TEST_CASE("Activations that are not one a channel are refused") {
  SurfelCloud cloud = random_cloud(3, kExtras);
  ActivatedSurfels a;
  cloud.extra_activations = {Activation::kTanh};
  CHECK_THROWS_WITH(activate(cloud, {}, 0, a), Catch::Contains("1 kinds of activation"));
  cloud.extra_activations.clear();
  a.options.opacity_factor = 2;
  CHECK_THROWS_WITH(activate(cloud, {}, 0, a), Catch::Contains("opacity factor 2"));
}
