// SPDX-License-Identifier: MIT
#include "glint/train/reflection_bootstrap.h"

#include <catch2/catch.hpp>

#include <cmath>

#include "glint/core/error.h"
#include "glint/render/activations.h"
#include "glint/render/glass_transport.h"
#include "glint/render/map_ops.h"

using namespace glint;

namespace {

constexpr ImageSize kSize{12, 9};

// A wall two metres away, of surfels with these specularities on top of each other.
SurfelCloud wall(const std::vector<float>& speculars) {
  SurfelCloud cloud;
  cloud.extra_names = {kSpecular};
  cloud.resize(speculars.size());
  for (std::size_t i = 0; i < speculars.size(); ++i) {
    cloud.means[3 * i + 2] = 2;
    cloud.rotations[4 * i] = 1;
    cloud.opacity_logits[i] = logit(0.3f);
    cloud.extra_logits[i] = logit(speculars[i]);
  }
  return cloud;
}

TrainableSet trainable_wall(const std::vector<float>& speculars) {
  SetTraining training;
  training.rates.extra = {0.01f};
  training.densify.until = 10000;
  training.densify.from = 9000;
  training.densify.reset_interval = 300;
  return TrainableSet(wall(speculars), training);
}

// One step with a gradient on every pixel's alpha.
void step(int number, TrainableSet& set) {
  const Camera camera = look_at({0, 0, 0}, {0, 0, 1}, {0, -1, 0}, kSize, 60);
  set.forward(camera, 0);
  RasterOutputGradient gradient;
  clear_gradient(kSize, 4, gradient);
  for (float& value : gradient.alpha.values()) value = -1;
  set.backward(gradient);
  set.update(number);
}

}  // namespace

TEST_CASE("Colour sabotage reaches what mirrors little, within its range, and its moments") {
  SurfelCloud cloud = wall({0.01f, 0.04f, 0.06f, 0.9f}), gradient = wall({1, 1, 1, 1});
  std::fill(gradient.sh_dc.begin(), gradient.sh_dc.end(), 1.0f);
  gradient.extra_logits.assign(4, 1.0f);
  SurfelAdam adam;
  SurfelRates rates;
  rates.sh_dc = 0;
  rates.extra = {0};
  adam.step(cloud, gradient, rates, 1);
  Rng rng(3);
  sabotage_colors(0.4f, 0.05f, rng, cloud, adam);
  for (std::size_t k = 0; k < 6; ++k) {
    CHECK(cloud.sh_dc[k] != 0.0f);
    CHECK(std::abs(cloud.sh_dc[k]) <= 0.4f);
  }
  CHECK(cloud.sh_dc[0] != cloud.sh_dc[1]);
  for (std::size_t k = 6; k < 12; ++k) CHECK(cloud.sh_dc[k] == 0.0f);
  for (const float moment : adam.first().sh_dc) CHECK(moment == 0.0f);
  for (const float moment : adam.second().sh_dc) CHECK(moment == 0.0f);
  CHECK(adam.first().extra_logits[0] > 0);
}

TEST_CASE("Colour sabotage spares a surfel with any extra channel above the threshold") {
  SurfelCloud cloud;
  cloud.extra_names = {kTransparency, kSpecular};
  cloud.resize(3);
  cloud.extra_logits = {logit(0.6f), logit(0.1f), logit(0.1f), logit(0.6f), logit(0.1f), -9};
  SurfelAdam adam;
  Rng rng(3);
  sabotage_colors(0.4f, 0.5f, rng, cloud, adam);
  for (std::size_t k = 0; k < 6; ++k) CHECK(cloud.sh_dc[k] == 0.0f);
  for (std::size_t k = 6; k < 9; ++k) CHECK(cloud.sh_dc[k] != 0.0f);
}

TEST_CASE("Normal propagation makes all opaque, and those that mirror grow") {
  SurfelCloud cloud = wall({0.01f, 0.03f});
  cloud.opacity_logits[1] = 8;
  SurfelAdam adam;
  propagate_normals(0.9f, 1.5f, 0.02f, cloud, adam);
  CHECK(sigmoid(cloud.opacity_logits[0]) == Approx(0.9f));
  CHECK(cloud.opacity_logits[1] == 8.0f);
  CHECK(cloud.log_scales[0] == 0.0f);
  for (const std::size_t k : {std::size_t{2}, std::size_t{3}})
    CHECK(std::exp(cloud.log_scales[k]) == Approx(1.5f));
  cloud.extra_names = {kTransparency};
  CHECK_THROWS_AS(propagate_normals(0.9f, 1.5f, 0.02f, cloud, adam), Error);
}

TEST_CASE("Both come at their intervals, within their window, and not with a reset") {
  BootstrapConfig config;
  config.color_sabotage = true;
  config.from = 100;
  config.until = 400;
  config.interval = 100;
  TrainableSet set = trainable_wall({0.01f});
  ReflectionBootstrap bootstrap(config, 0);
  std::vector<int> steps;
  for (int number = 1; number <= 600; ++number) {
    const float before = set.cloud().sh_dc[0];
    bootstrap.update(number, set);
    if (set.cloud().sh_dc[0] != before) steps.push_back(number);
  }
  CHECK(steps == std::vector<int>{200, 400});  // 300 has a reset
}

TEST_CASE("After a growth opacities stay until the pause is over") {
  BootstrapConfig config;
  config.normal_propagation = true;
  config.from = 0;
  config.interval = 100;
  config.opacity_pause = 20;
  TrainableSet set = trainable_wall({0.5f});
  ReflectionBootstrap bootstrap(config, 0);
  const auto opacity_after = [&](int number) {
    step(number, set);
    bootstrap.update(number, set);
    return sigmoid(set.cloud().opacity_logits[0]);
  };
  const float before = opacity_after(99);
  CHECK(before > 0.3f);
  CHECK(opacity_after(100) == Approx(0.9f));
  for (const int number : {101, 119}) CHECK(opacity_after(number) == Approx(0.9f));
  CHECK(opacity_after(120) > 0.901f);
  CHECK(set.cloud().log_scales[0] == Approx(std::log(1.5f)).margin(0.1));
}
