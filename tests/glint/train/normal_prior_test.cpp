// SPDX-License-Identifier: MIT
#include "glint/train/normal_prior.h"

#include "tests/support/check_loss.h"

using namespace glint;
using namespace glint::test;

namespace {

auto loss_of(const NormalPriorLoss& loss, const Image& prior, const Image& weights = {}) {
  return [=](const auto& normal, auto weight, auto& gradient) {
    return loss.evaluate(normal, prior, weights, weight, gradient);
  };
}
auto loss_with(const Image& prior, float min_cosine, const Image& weights = {}) {
  return loss_of(NormalPriorLoss{min_cosine}, prior, weights);
}
NormalPriorLoss weighted_mean() {
  NormalPriorLoss loss;
  loss.weighted_mean = true;
  return loss;
}
constexpr float kNoGate = NormalPriorLoss::kNoGate;

// Four pixels: the prior's normal at half length, cosine 0.6, cosine -1, no prior.
const std::vector<float> kPriors{0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, 0};
const std::vector<float> kNormals{0, 0, -0.5f, 0.4f, 0, -0.3f, 0, 0, 1, 0.5f, 0.5f, -0.5f};

}  // namespace

TEST_CASE("The normal prior's loss is the mean of 1 - cosine over the pixels with a prior") {
  const Image prior = map_of<float>(4, 1, 3, kPriors), normal = map_of<float>(4, 1, 3, kNormals);
  CHECK(value_of(loss_with(prior, kNoGate), normal) == Approx((0 + 0.4 + 2) / 3));
  const Image weights = map_of<float>(4, 1, 1, {1, 0.5f, 0.25f, 1});
  CHECK(value_of(loss_with(prior, kNoGate, weights), normal) == Approx((0.2 + 0.5) / 3));
}

TEST_CASE("A weighted mean is over the weights of the pixels with a prior") {
  const Image prior = map_of<float>(4, 1, 3, kPriors), normal = map_of<float>(4, 1, 3, kNormals);
  const Image weights = map_of<float>(4, 1, 1, {1, 0.5f, 0.25f, 1});
  CHECK(value_of(loss_of(weighted_mean(), prior, weights), normal) == Approx((0.2 + 0.5) / 1.75));
  CHECK(value_of(loss_of(weighted_mean(), prior), normal) == Approx((0 + 0.4 + 2) / 3));
  check_no_loss(normal, loss_of(weighted_mean(), prior, Image(4, 1, 1)));
}

TEST_CASE("Pixels below the gate count as zero and have no gradient") {
  const Image prior = map_of<float>(4, 1, 3, kPriors), normal = map_of<float>(4, 1, 3, kNormals);
  CHECK(value_of(loss_with(prior, 0.5f), normal) == Approx(0.4 / 3));
  const Image gradient = gradient_of(loss_with(prior, 0.5f), normal);
  CHECK(gradient.at(1, 0, 0) != 0.0f);
  for (int c = 0; c < 3; ++c) {
    CHECK(gradient.at(2, 0, c) == 0.0f);
    CHECK(gradient.at(3, 0, c) == 0.0f);
  }
  CHECK(value_of(loss_with(prior, 0.7f), normal) == Approx(0).margin(1e-7));
}

TEST_CASE("A pixel without a rendered normal counts as cosine zero, without gradient") {
  const Image prior = map_of<float>(1, 1, 3, {0, 0, -1}), nothing(1, 1, 3);
  CHECK(value_of(loss_with(prior, kNoGate), nothing) == 1);
  CHECK(gradient_of(loss_with(prior, kNoGate), nothing).at(0, 0, 2) == 0.0f);
  CHECK(value_of(loss_with(prior, 0.3f), nothing) == 0);
}

TEST_CASE("Without normal priors there is no loss") {
  const Image normal = map_of<float>(4, 1, 3, kNormals);
  check_no_loss(normal, loss_with({}, kNoGate));
  check_no_loss(normal, loss_with(Image(4, 1, 3), kNoGate));
}

TEST_CASE("Normal priors with one channel or weights of another size are refused") {
  const Image normal(4, 2, 3), prior(4, 2, 3);
  CHECK_THROWS_AS(value_of(loss_with(Image(4, 2, 1), kNoGate), normal), Error);
  CHECK_THROWS_AS(value_of(loss_with(prior, kNoGate, Image(2, 4, 1)), normal), Error);
}

TEST_CASE("The inverse depth weight falls from near to far between the outer percents") {
  Image depth(
      20, 20, 1
  );  // 400 depths 1 .. 400 in a scrambled order: 4 nearer than 5, 4 beyond 396
  for (int i = 0; i < 400; ++i) depth.data()[(i * 37) % 400] = static_cast<float>(i + 1);
  const Image weights = inverse_depth_weight(depth);
  const auto at = [&](int z) { return static_cast<double>(weights.data()[((z - 1) * 37) % 400]); };
  CHECK(at(1) == 1);
  CHECK(at(5) == 1);
  CHECK(at(6) == Approx(1 - 1.0 / 391));
  CHECK(at(200) == Approx(1 - 195.0 / 391));
  CHECK(at(396) == 0);
  CHECK(at(400) == 0);
}

TEST_CASE("Missing depth weighs nothing and constant depth one") {
  const Image weights = inverse_depth_weight(map_of<float>(3, 1, 1, {2, 0, 2}));
  CHECK(weights.at(0, 0) == 1.0f);
  CHECK(weights.at(1, 0) == 0.0f);
  CHECK(inverse_depth_weight(Image(2, 2, 1)).at(1, 1) == 0.0f);
}
