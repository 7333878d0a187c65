// SPDX-License-Identifier: MIT
// Density control beyond clone, split and prune: the holiday after resets, the slow window, what is
// decided by visibility, resets of channels.
#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>

#include "glint/core/error.h"
#include "glint/render/activations.h"
#include "tests/support/densified_set.h"

using namespace glint;
using namespace glint::test;

namespace {

// The step in which surfels that stay as a reset leaves them are pruned.
int pruned_in_step(int holiday) {
  DensifyConfig config = every_step();
  config.prune_holiday = holiday;
  DensifiedSet set(config, 2);
  for (int step = 1; step <= 30; ++step) {
    set.observe({1, 1});
    if (set.update(step).pruned > 0) return step;
    if (step == config.reset_interval) set.cloud.opacity_logits[1] = 1;
  }
  return 0;
}

}  // namespace

TEST_CASE("After an opacity reset none is pruned for its opacity until the holiday is over") {
  CHECK(pruned_in_step(0) == 11);
  CHECK(pruned_in_step(1) == 11);
  CHECK(pruned_in_step(4) == 14);
  CHECK(pruned_in_step(9) == 19);
  CHECK(pruned_in_step(10) == 20);  // in the step of the next reset, before it
  CHECK(pruned_in_step(11) == 0);   // for_views() keeps resets further apart than that
}

TEST_CASE("Before the first reset, and without any, there is no holiday") {
  for (const bool resets : {true, false}) {
    DensifyConfig config = every_step();
    config.prune_holiday = 1000;
    config.resets = resets;
    SurfelCloud surfels = cloud_of(1);
    surfels.opacity_logits[0] = logit(0.01f);
    DensifiedSet set(config, surfels);
    set.observe({1});
    CHECK(set.update(resets ? 5 : 15).pruned == 1);
  }
}

TEST_CASE(
    "The holiday is 200 steps or two epochs, and resets leave a third of their time to pruning"
) {
  DensifyConfig config;
  CHECK(config.for_views(0).prune_holiday == 200);
  CHECK(config.for_views(100).prune_holiday == 200);
  CHECK(config.for_views(280).prune_holiday == 560);
  CHECK(config.for_views(280).reset_interval == 3000);
  config.reset_interval = 300;  // the shortest of short runs
  CHECK(config.for_views(48).reset_interval == 300);
  CHECK(config.for_views(280).reset_interval == 840);
  config.resets = false;
  CHECK(config.for_views(280).reset_interval == 300);
  config = {};
  config.reset_interval = 300;
  config.prune_holiday = 0;
  CHECK(config.for_views(280).prune_holiday == 0);
  CHECK(config.for_views(280).reset_interval == 300);
  config.prune_holiday = 500;
  CHECK(config.for_views(10).prune_holiday == 500);
  CHECK(config.for_views(10).reset_interval == 750);
}

TEST_CASE("Within the slow window densifications are further apart") {
  DensifyConfig config;
  CHECK(config.interval_at(10000) == 100);
  config.slow_interval = 500;
  for (const auto& [step, interval] :
       {std::pair{3000, 100}, {3001, 500}, {18000, 500}, {18001, 100}})
    CHECK(config.interval_at(step) == interval);
  config.scale([](int published, int at_least) { return std::max(published / 10, at_least); });
  CHECK(config.interval_at(300) == 50);
  CHECK(config.interval_at(301) == 50);  // 500 / 10
  CHECK(config.reset_interval == 300);
  CHECK(config.slow_until == 1800);
}

TEST_CASE("A large surfel becomes five in its plane, unless it is among the least seen") {
  for (const float weight : {5.0f, 0.5f}) {
    DensifyConfig config = every_step();
    config.split_large = true;
    SurfelCloud surfels = cloud_of(12);
    enlarge(surfels, 0);
    DensifiedSet set(config, surfels);
    std::vector<float> weights(12, 1.0f);
    weights[0] = weight;
    set.observe(weights);
    const DensifyCounts counts = set.update(1);
    const bool split = weight > 1;
    CHECK(counts.split == (split ? 1 : 0));
    CHECK(counts.pruned == (split ? 0 : 1));
    REQUIRE(set.cloud.size() == (split ? 16 : 11));
    CHECK(set.adam.first().size() == set.cloud.size());
    CHECK(set.cloud.means[0] == 1.0f);  // the parent is gone
    for (std::size_t child = 11; child < set.cloud.size(); ++child) {
      CHECK(std::exp(set.cloud.log_scales[2 * child]) == Approx(kLarge / 2.5f));
      CHECK(set.cloud.means[3 * child + 2] == 0.0f);
      CHECK(set.cloud.means[3 * child] != 0.0f);
      CHECK(std::abs(set.cloud.means[3 * child]) < 5 * kLarge);
    }
  }
}

TEST_CASE("Large surfels become five as long as there is room for them") {
  DensifyConfig config = every_step();
  config.split_large = true;
  const auto split_with = [&](int max_surfels) {
    config.max_surfels = max_surfels;
    SurfelCloud surfels = cloud_of(12);
    for (std::size_t i = 0; i < 3; ++i) enlarge(surfels, i);
    DensifiedSet set(config, surfels);
    set.observe(std::vector<float>(12, 1.0f));
    const DensifyCounts counts = set.update(1);
    CHECK(counts.pruned == 0);
    CHECK(set.cloud.size() == 12 + 4 * counts.split);
    return counts.split;
  };
  CHECK(split_with(100) == 3);
  CHECK(split_with(23) == 2);
  CHECK(split_with(15) == 0);
  CHECK(split_with(5) == 0);
}

TEST_CASE("Weights are means over the views that saw a surfel") {
  // Two large surfels: the first is seen often and faintly, the second once and well.
  DensifyConfig config = every_step();
  config.split_large = true;
  SurfelCloud surfels = cloud_of(12);
  enlarge(surfels, 0);
  enlarge(surfels, 1);
  DensifiedSet set(config, surfels);
  std::vector<float> weights(12, 3.0f);
  weights[0] = 2;
  weights[1] = 4;
  set.observe(weights);
  weights[1] = 0;
  set.observe(weights);
  set.observe(weights);  // sums: 6 and 4
  const DensifyCounts counts = set.update(1);
  CHECK(counts.pruned == 1);
  CHECK(counts.split == 1);
  CHECK(set.cloud.means[0] == 2.0f);
}

TEST_CASE("Rows of the least weight go, new ones last") {
  constexpr float kUnseen = DensifyRows::kUnseen;
  DensifyRows rows{{1, 1, 0, 1, 1, 1}, {3, 1, 0, 2, kUnseen, 1}};
  DensifyCounts counts;
  drop_lightest(5, rows, counts);
  CHECK(counts.pruned == 0);
  drop_lightest(3, rows, counts);
  CHECK(rows.keep == std::vector<std::uint8_t>{1, 0, 0, 1, 1, 0});
  CHECK(counts.pruned == 2);
  drop_lightest(1, rows, counts);
  CHECK(rows.keep == std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0});
  CHECK(counts.pruned == 4);
}

TEST_CASE("A cap by visibility lets surfels grow, and takes those least seen down to 0.9 of it") {
  DensifyConfig config = every_step();
  config.cap_by_visibility = true;
  config.max_surfels = 10;
  DensifiedSet set(config, 10);
  std::vector<float> weights(10), gradients(10, 0.0f);
  std::iota(weights.begin(), weights.end(), 1.0f);
  gradients[0] = gradients[9] = 1;
  set.observe(weights, gradients);
  const DensifyCounts counts = set.update(1);
  CHECK(counts.cloned == 2);
  CHECK(counts.pruned == 3);
  REQUIRE(set.cloud.size() == 9);
  CHECK(set.cloud.means[0] == 3.0f);  // 0, 1 and 2 went, the clone of 0 did not
  CHECK(set.cloud.means[3 * 7] == 0.0f);
  CHECK(set.cloud.means[3 * 8] == 9.0f);
}

TEST_CASE("An opacity reset lowers the channels that it names, from their step on") {
  DensifyConfig config = every_step();
  config.channel_resets = {{"transparency", 0.01f}, {"specular", 0.001f, 15}};
  SurfelCloud cloud, gradient;
  for (SurfelCloud* c : {&cloud, &gradient}) {
    c->extra_names = {"transparency", "specular"};
    c->resize(2);
    std::fill(c->log_scales.begin(), c->log_scales.end(), std::log(kSmall));
  }
  cloud.opacity_logits = {1, 1};
  gradient.extra_logits = {1, 1, 1, 1};
  SurfelRates rates;
  rates.extra = {0, 0};
  SurfelAdam adam;
  adam.step(cloud, gradient, rates, 1);
  cloud.extra_logits = {2, 2, logit(1e-4f), logit(1e-4f)};
  Densifier densifier(config, 1, 0);
  densifier.update(10, cloud, adam);
  CHECK(sigmoid(cloud.extra_logits[0]) == Approx(0.01f));
  CHECK(cloud.extra_logits[1] == 2.0f);
  CHECK(cloud.extra_logits[2] == logit(1e-4f));  // below already
  CHECK(adam.first().extra_logits[0] == 0.0f);
  CHECK(adam.first().extra_logits[1] > 0);
  cloud.opacity_logits = {1, 1};
  densifier.update(20, cloud, adam);
  CHECK(sigmoid(cloud.extra_logits[1]) == Approx(0.001f));
  CHECK(adam.second().extra_logits[1] == 0.0f);
  config.channel_resets = {{"roughness", 0.1f}};
  Densifier of_another(config, 1, 0);
  CHECK_THROWS_WITH(of_another.update(10, cloud, adam), Catch::Contains("roughness"));
}

TEST_CASE("A channel may be reset halfway between the resets of opacity, after the first") {
  DensifyConfig config = every_step();
  config.channel_resets = {{"surface_opacity", 0.01f, 0, true}};
  SurfelCloud cloud, gradient;
  for (SurfelCloud* c : {&cloud, &gradient}) {
    c->extra_names = {"surface_opacity"};
    c->resize(1);
    std::fill(c->log_scales.begin(), c->log_scales.end(), std::log(kSmall));
  }
  SurfelRates rates;
  rates.extra = {0};
  SurfelAdam adam;
  adam.step(cloud, gradient, rates, 1);
  Densifier densifier(config, 1, 0);
  for (const int step : {5, 10, 14, 15, 20, 25}) {
    cloud.opacity_logits = {1};
    cloud.extra_logits = {2};
    const bool reset = densifier.update(step, cloud, adam).reset;
    INFO(step);
    CHECK(reset == (step % 10 == 0));
    CHECK((sigmoid(cloud.extra_logits[0]) < 0.011f) == (step == 15 || step == 25));
    CHECK((cloud.opacity_logits[0] < 1) == reset);
  }
}

TEST_CASE("A view that is rasterised twice counts with the length of the summed gradient") {
  DensifyConfig config = every_step();
  config.gradient_threshold = 0.9f;
  RasterOutput output;
  output.alpha = Image(1, config.reference_rows, 1);
  output.in_view = {1, 1, 1};
  RasterGradient a, b;
  a.screen = {0.5f, 0, 0.5f, 0, 0, 0};
  b.screen = {0.5f, 0, -0.5f, 0, 0, 0.5f};
  DensifiedSet set(config, 3);
  set.densifier.observe(output, a, &b);
  CHECK(set.update(1).cloned == 1);
  CHECK(set.cloud.means[3 * 3] == 0.0f);  // the first, whose gradients agree
}

TEST_CASE("A densifier knows how near a step is to a reset") {
  DensifyConfig config = every_step();
  config.until = 25;
  const Densifier densifier(config, 1, 0);
  for (const int step : {8, 9, 10, 11, 12, 18, 22}) CHECK(densifier.resets_within(step, 2));
  for (const int step : {1, 2, 7, 13, 17, 23, 28, 30})
    CHECK_FALSE(densifier.resets_within(step, 2));
  config.resets = false;
  CHECK_FALSE(Densifier(config, 1, 0).resets_within(10, 2));
}

TEST_CASE("A set is not pruned below its least, and the faintest go first") {
  DensifyConfig config = every_step();
  config.min_surfels = 3;
  SurfelCloud surfels = cloud_of(5);
  for (std::size_t i = 0; i < 4; ++i)
    surfels.opacity_logits[i] = logit(0.04f - 0.01f * static_cast<float>(i));
  DensifiedSet set(config, surfels);
  set.observe(std::vector<float>(5, 1.0f));
  CHECK(set.update(1).pruned == 2);
  REQUIRE(set.cloud.size() == 3);
  for (std::size_t i = 0; i < 2; ++i) CHECK(set.cloud.means[3 * i] == static_cast<float>(i));
  CHECK(set.cloud.means[6] == 4);
}

TEST_CASE("The least of a set is a share of what it starts with, or a number") {
  DensifyConfig config;
  config.min_share = 0.05f;
  CHECK(config.for_surfels(1000).min_surfels == 50);
  config.min_surfels = 64;
  CHECK(config.for_surfels(1000).min_surfels == 64);
}

TEST_CASE("Of large surfels only the lightest tenth and those not seen go, if asked for") {
  DensifyConfig config = every_step();
  config.prune_light_large = true;
  SurfelCloud surfels = cloud_of(20);
  for (const std::size_t i : {0u, 1u, 5u, 19u}) enlarge(surfels, i);
  DensifiedSet set(config, surfels);
  std::vector<float> weights(20);
  std::iota(weights.begin(), weights.end(), 0.0f);  // 0: not seen; 1: among the lightest tenth
  set.observe(weights);
  const int step = config.reset_interval + 1;
  CHECK(set.update(step).pruned == 2);
  CHECK(set.cloud.means[0] == 2);
  CHECK(set.cloud.means[3 * 3] == 5);  // large, and seen
}

TEST_CASE("A quantile of the observed gradients lowers the threshold, and never raises it") {
  for (const float scale : {1.0f, 100.0f}) {
    DensifyConfig config = every_step();
    config.gradient_threshold = 1e-3f;
    config.gradient_quantile = 0.5f;
    DensifiedSet set(config, 5);
    std::vector<float> gradients;
    for (int i = 1; i <= 5; ++i) gradients.push_back(scale * 1e-4f * static_cast<float>(i));
    set.observe(std::vector<float>(5, 1.0f), gradients);
    CHECK(set.update(1).cloned == (scale == 1 ? 3 : 5));
  }
}

TEST_CASE("Where there is no room for all, the largest gradients grow") {
  DensifyConfig config = every_step();
  config.max_surfels = 6;
  DensifiedSet set(config, 4);
  set.observe({1, 1, 1, 1}, {0.1f, 0.4f, 0.2f, 0.3f});
  set.update(1);
  REQUIRE(set.cloud.size() == 6);
  CHECK(set.cloud.means[3 * 4] == 1);
  CHECK(set.cloud.means[3 * 5] == 3);
}

TEST_CASE("Scales above their limit are lowered to it, and their moments forgotten") {
  DensifyConfig config;
  config.scale_limit = 0.1f;
  SurfelCloud cloud = cloud_of(2), gradient = cloud_of(2);
  SurfelAdam adam;
  adam.step(cloud, gradient, {}, 1);
  enlarge(cloud, 1);
  const float small = cloud.log_scales[0], moment = adam.first().log_scales[0];
  const Densifier densifier(config, 2, 0);
  densifier.limit_scales(cloud, adam);
  CHECK(cloud.log_scales[0] == small);
  CHECK(adam.first().log_scales[0] == moment);
  CHECK(moment != 0);
  for (const std::size_t i : {2u, 3u}) {
    CHECK(std::exp(cloud.log_scales[i]) == Approx(0.2f));
    CHECK(adam.first().log_scales[i] == 0);
    CHECK(adam.second().log_scales[i] == 0);
  }
}
