// SPDX-License-Identifier: MIT
// Adam and densification.
#include <catch2/catch.hpp>

#include <cmath>
#include <string_view>
#include <utility>

#include "glint/render/activations.h"
#include "glint/train/pixel_losses.h"
#include "glint/train/trainable_set.h"
#include "tests/support/densified_set.h"

using namespace glint;
using namespace glint::test;

TEST_CASE("Adam follows its recurrence in double and clears the gradient") {
  SurfelCloud cloud = cloud_of(3), gradient = cloud_of(3);
  SurfelAdam adam;
  SurfelRates rates;
  double m = 0, v = 0, x = static_cast<double>(cloud.opacity_logits[1]);
  for (int t = 1; t <= 5; ++t) {
    gradient.opacity_logits = {0, 0.3f * static_cast<float>(t), 0};
    adam.step(cloud, gradient, rates, 1);
    const double g = 0.3 * t;
    m = 0.9 * m + 0.1 * g;
    v = 0.999 * v + 0.001 * g * g;
    x -= 0.05 * (m / (1 - std::pow(0.9, t))) / std::sqrt(v / (1 - std::pow(0.999, t)));
    CHECK(static_cast<double>(cloud.opacity_logits[1]) == Approx(x).epsilon(1e-5));
    CHECK(gradient.opacity_logits[1] == 0.0f);
    CHECK(cloud.opacity_logits[0] == 1.0f);  // no gradient, no moment, no step
  }
}

TEST_CASE("A log-linear rate ends where it should") {
  CHECK(log_linear_rate(1e-2f, 1e-4f, 0, 10) == Approx(1e-2));
  CHECK(log_linear_rate(1e-2f, 1e-4f, 5, 10) == Approx(1e-3));
  CHECK(log_linear_rate(1e-2f, 1e-4f, 30, 10) == Approx(1e-4));
}

TEST_CASE("A rate that falls log-linearly to zero is an error; what starts at zero stays there") {
  CHECK(log_linear_rate(0, 1e-4f, 5, 10) == 0);
  CHECK(log_linear_rate(0, 0, 5, 10) == 0);
  CHECK_THROWS_WITH(log_linear_rate(1e-2f, 0, 0, 10), Catch::Contains("above 0"));
  SurfelCloud cloud = cloud_of(1), gradient = cloud_of(1);
  SurfelRates rates;
  rates.means_final = 0;
  CHECK_THROWS_WITH(SurfelAdam().step(cloud, gradient, rates, 1), Catch::Contains("above 0"));
  rates.means = 0;
  gradient.means[0] = 1;
  const FloatArray before = cloud.means;
  SurfelAdam().step(cloud, gradient, rates, 1);
  CHECK(cloud.means == before);
}

TEST_CASE("The position rate falls log-linearly to its final value") {
  SurfelRates rates;
  rates.means_steps = 100;
  CHECK(position_rate(rates, 0) == Approx(1.6e-4));
  CHECK(position_rate(rates, 50) == Approx(1.6e-5));
  CHECK(position_rate(rates, 100) == Approx(1.6e-6));
  CHECK(position_rate(rates, 500) == Approx(1.6e-6));
}

TEST_CASE("A small surfel with a large gradient is cloned, a large one split, others stay") {
  SurfelCloud surfels = cloud_of(3);
  surfels.log_scales[4] = surfels.log_scales[5] = std::log(0.05f);
  DensifiedSet set(every_step(), surfels);
  set.observe({1, 1, 1}, {0, 1, 1});
  const DensifyCounts counts = set.update(1);
  const SurfelCloud& cloud = set.cloud;
  CHECK(counts.cloned == 1);
  CHECK(counts.split == 1);
  REQUIRE(cloud.size() == 5);  // 0, 1, clone of 1, two children of 2
  CHECK(cloud.means[3 * 2] == cloud.means[3 * 1]);
  for (std::size_t child : {std::size_t{3}, std::size_t{4}})
    CHECK(std::exp(cloud.log_scales[2 * child]) == Approx(0.05f / 1.6f));
  // Children lie in the parent's plane (its normal is z).
  CHECK(cloud.means[3 * 3 + 2] == Approx(cloud.means[2]).margin(1e-6));
  CHECK(cloud.means[3 * 3] != cloud.means[3 * 4]);
  CHECK(set.adam.first().size() == 5);
}

TEST_CASE("Faint surfels are pruned and moments keep to their rows") {
  SurfelCloud surfels = cloud_of(4), gradient = cloud_of(4);
  surfels.opacity_logits[1] = logit(0.01f);
  DensifiedSet set(every_step(), surfels);
  for (std::size_t i = 0; i < 4; ++i) gradient.means[3 * i] = static_cast<float>(i + 1);
  set.adam.step(set.cloud, gradient, {}, 1);
  set.observe({1, 1, 1, 1});
  CHECK(set.update(1).pruned == 1);
  REQUIRE(set.cloud.size() == 3);
  CHECK(set.adam.first().means[3] == Approx(0.3f));  // surfel 2 moved to row 1
}

TEST_CASE("Large surfels are pruned only after the first opacity reset; resets lower opacities") {
  DensifyConfig config = every_step();
  config.reset_interval = 2;
  SurfelCloud surfels = cloud_of(2);
  surfels.log_scales[0] = std::log(kLarge);
  DensifiedSet set(config, surfels);
  set.observe({1, 1});
  set.update(1);
  CHECK(set.cloud.size() == 2);
  set.observe({1, 1});
  set.update(2);
  CHECK(sigmoid(set.cloud.opacity_logits[1]) == Approx(0.01f));
  set.cloud.opacity_logits = {1, 1};
  set.observe({1, 1});
  CHECK(set.update(3).pruned == 1);
}

TEST_CASE(
    "The gradient statistic does not depend on the image size for surfels of equal size in pixels"
) {
  // Half the rows: every surfel's NDC gradient doubles, and so may the one that just stays below.
  DensifiedSet set(every_step(), 2);
  RasterOutput output;
  output.in_view = {1, 1};
  output.alpha = Image(480, 270, 1);
  RasterGradient statistic;
  statistic.screen = {3.8e-4f, 0, 4.2e-4f, 0};
  set.densifier.observe(output, statistic);
  CHECK(set.update(1).cloned == 1);
}

TEST_CASE("Growth stops at the cap") {
  DensifyConfig config = every_step();
  config.max_surfels = 12;
  DensifiedSet set(config, 10);
  set.observe(std::vector<float>(10, 1.0f), std::vector<float>(10, 1.0f));
  set.update(1);
  CHECK(set.cloud.size() == 12);
}

TEST_CASE("Shorter runs move faster by the fourth root, longer ones as published") {
  const SurfelRates published;
  const SurfelRates sixteenth = published.for_shorter_run(16);
  CHECK(sixteenth.means == Approx(2 * published.means));
  CHECK(sixteenth.means_final == Approx(2 * published.means_final));
  CHECK(sixteenth.sh_rest == Approx(2 * published.sh_rest));
  CHECK(sixteenth.opacity == published.opacity);
  CHECK(sixteenth.means_steps == 30000 / 16);
  CHECK(published.for_shorter_run(1).means == published.means);
  CHECK(published.for_shorter_run(0.5).means == published.means);
  CHECK(published.for_shorter_run(0.5).means_steps == 60000);
}

TEST_CASE("Without opacity resets opacities stay, and large surfels go as they would with them") {
  DensifyConfig config = every_step();
  config.reset_interval = 2;
  config.resets = false;
  SurfelCloud surfels = cloud_of(2);
  surfels.log_scales[0] = std::log(kLarge);
  DensifiedSet set(config, surfels);
  const FloatArray before = set.cloud.opacity_logits;
  set.observe({1, 1});
  set.update(2);
  CHECK(set.cloud.opacity_logits == before);
  set.observe({1, 1});
  CHECK(set.update(3).pruned == 1);
}

TEST_CASE("Each extra channel has its own rate") {
  SurfelCloud cloud, gradient;
  for (SurfelCloud* c : {&cloud, &gradient}) {
    c->extra_names = {"transparency", "specular"};
    c->resize(3);
  }
  std::fill(gradient.extra_logits.begin(), gradient.extra_logits.end(), 1.0f);
  CHECK_THROWS_WITH(
      SurfelAdam().step(cloud, gradient, {}, 1), Catch::Contains("0 rates for 2 extra channels")
  );
  SurfelRates rates;
  rates.extra = {0.05f, 0.01f};
  SurfelAdam().step(cloud, gradient, rates, 1);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(cloud.extra_logits[2 * i] == Approx(-0.05f));
    CHECK(cloud.extra_logits[2 * i + 1] == Approx(-0.01f));
  }
}

TEST_CASE(
    "A penalty of opacities is the mean of those in view and has its gradient, in any number "
    "of rows"
) {
  for (const std::size_t count : {1u, 256u, 700u}) {
    SurfelCloud cloud = cloud_of(count);
    for (std::size_t i = 0; i < count; ++i)
      cloud.opacity_logits[i] = 0.01f * static_cast<float>(i) - 2;
    TrainableSet set(cloud, SetTraining{});
    Array<std::uint8_t> in_view(count, 0);
    for (std::size_t i = 0; i < count; i += 3) in_view[i] = 1;
    const auto seen = static_cast<double>((count + 2) / 3);
    const auto opacity = [&](std::size_t i) {
      return 1 / (1 + std::exp(-static_cast<double>(cloud.opacity_logits[i])));
    };
    double mean = 0;
    for (std::size_t i = 0; i < count; i += 3) mean += opacity(i) / seen;
    CHECK(set.penalise_opacity(3, in_view) == Approx(mean));
    for (std::size_t i = 0; i < count; ++i) {
      const double slope = i % 3 == 0 ? 3 * opacity(i) * (1 - opacity(i)) / seen : 0;
      CHECK(static_cast<double>(set.gradient().opacity_logits[i]) == Approx(slope));
    }
    TrainableSet other(cloud, SetTraining{});
    double entropy = 0;
    for (std::size_t i = 0; i < count; i += 3) {
      const double o = opacity(i);
      entropy -= (o * std::log(o) + (1 - o) * std::log1p(-o)) / seen;
    }
    CHECK(other.penalise_opacity_entropy(3, in_view) == Approx(entropy));
    for (std::size_t i = 0; i < count; ++i) {
      const double o = opacity(i), x = static_cast<double>(cloud.opacity_logits[i]);
      const double slope = i % 3 == 0 ? -3 * x * o * (1 - o) / seen : 0;
      CHECK(static_cast<double>(other.gradient().opacity_logits[i]) == Approx(slope));
    }
    in_view.fill(0);
    CHECK(set.penalise_opacity(3, in_view) == 0);
    CHECK(set.penalise_opacity_entropy(3, in_view) == 0);
  }
}

TEST_CASE("the entropy of opacities that are certain is that of the clamp, and has no slope") {
  SurfelCloud cloud = cloud_of(2);
  cloud.opacity_logits[0] = 200, cloud.opacity_logits[1] = -200;
  TrainableSet set(cloud, SetTraining{});
  Array<std::uint8_t> in_view(2, 1);
  // -p log p - (1 - p) log(1 - p) at clamped_probability()'s least p.
  const double least = static_cast<double>(clamped_probability(0.0f));
  const double entropy = -least * std::log(least) - (1 - least) * std::log1p(-least);
  CHECK(set.penalise_opacity_entropy(1, in_view) == Approx(entropy).epsilon(0.05));  // 1 - p rounds
  for (const float slope : set.gradient().opacity_logits) CHECK(slope == 0);
}

TEST_CASE("A penalty of a channel's entropy is its mean by weight in the picture, with its gradient"
) {
  SurfelCloud cloud = cloud_of(300);
  cloud.extra_names = {"transparency", "specular"};
  cloud.resize(300);
  FloatArray visibility(300, 0.0f);
  for (std::size_t i = 0; i < 300; ++i) {
    cloud.extra_logits[2 * i] = 0.02f * static_cast<float>(i) - 3;
    visibility[i] = i % 3 == 0 ? 0.1f * static_cast<float>(i + 1) : 0.0f;
  }
  TrainableSet set(cloud, SetTraining{});
  double sum = 0, entropy = 0;
  const auto share = [&](std::size_t i) {
    return 1 / (1 + std::exp(-static_cast<double>(cloud.extra_logits[2 * i])));
  };
  for (std::size_t i = 0; i < 300; ++i) {
    const double p = share(i), v = static_cast<double>(visibility[i]);
    sum += v;
    entropy -= v * (p * std::log(p) + (1 - p) * std::log1p(-p));
  }
  CHECK(set.penalise_entropy(3, 0, visibility) == Approx(entropy / sum));
  for (std::size_t i = 0; i < 300; ++i) {
    const double p = share(i), x = static_cast<double>(cloud.extra_logits[2 * i]);
    const double slope = -3 * x * p * (1 - p) * static_cast<double>(visibility[i]) / sum;
    CHECK(static_cast<double>(set.gradient().extra_logits[2 * i]) == Approx(slope).margin(1e-9));
    CHECK(set.gradient().extra_logits[2 * i + 1] == 0);
  }
  CHECK(set.penalise_entropy(3, 0, FloatArray(300, 0.0f)) == 0);
}

TEST_CASE("Positions may slow down by the steps of the run") {
  SurfelRates rates;
  rates.means_steps = 100;
  const auto moved = [&](int first_step, bool run_clock = true) {
    SurfelRates of_run = rates;
    of_run.first_step = first_step;
    of_run.run_clock = run_clock;
    SurfelCloud cloud = cloud_of(1), gradient = cloud_of(1);
    const float before = cloud.means[0];
    gradient.means[0] = 1;
    SurfelAdam adam;
    adam.step(cloud, gradient, of_run, 1);
    return static_cast<double>(before - cloud.means[0]);
  };
  CHECK(moved(0) == Approx(static_cast<double>(rates.means)).epsilon(1e-3));
  CHECK(moved(100) == Approx(static_cast<double>(rates.means_final)).epsilon(0.1));
  CHECK(moved(100, false) == moved(0));
}

TEST_CASE("Rates settle over a window of the run, positions by their own schedule") {
  SurfelRates rates;
  rates.settled = 0.01f;
  rates.settle_from = 100;
  rates.settle_until = 300;
  const SurfelRates half = rates.for_shorter_run(2);
  CHECK(half.settle_from == 50);
  CHECK(half.settle_until == 150);
  const auto moved = [&](int first_step, const char* name) {
    rates.first_step = first_step;
    SurfelCloud cloud = cloud_of(1), gradient = cloud_of(1);
    float change = 0;
    gradient.for_each_array([](const char*, FloatArray& a, std::size_t) {
      if (!a.empty()) a[0] = 1;
    });
    cloud.for_each_array([&](const char* n, FloatArray& a, std::size_t) {
      if (std::string_view(n) == name) change = a[0];
    });
    SurfelAdam().step(cloud, gradient, rates, 1);
    cloud.for_each_array([&](const char* n, FloatArray& a, std::size_t) {
      if (std::string_view(n) == name) change -= a[0];
    });
    return static_cast<double>(change);
  };
  for (const auto& [step, share] : {std::pair(0, 1.0), {100, 1.0}, {200, 0.1}, {300, 0.01}}) {
    CHECK(moved(step, "opacity_logits") == Approx(0.05 * share).epsilon(0.01));
    CHECK(moved(step, "sh_dc") == Approx(2.5e-3 * share).epsilon(0.01));
    CHECK(moved(step, "means") == Approx(position_rate(rates, step)).epsilon(0.01));
  }
}
