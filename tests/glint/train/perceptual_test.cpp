// SPDX-License-Identifier: MIT
#include "glint/train/perceptual.h"

#include <cstdlib>

#include "glint/scene/scene.h"
#include "metrics/lpips.h"
#include "tests/metrics/golden_images.h"
#include "tests/support/lpips_weights_here.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kWidth = 48, kHeight = 40;

Scene scene_of(int width, int height) {
  Scene scene;
  scene.train.resize(1);
  scene.train[0].name = "first";
  scene.train[0].camera.width = width, scene.train[0].camera.height = height;
  return scene;
}

struct Wanted {
  PerceptualConfig config;
  std::vector<std::string> warnings;
  std::unique_ptr<PerceptualLoss> loss;
  Wanted(const Scene& scene, PerceptualConfig asked = {}) : config(asked) {
    loss = wanted_perceptual_loss(config, scene, "method", warnings);
  }
  bool says(const std::string& text) const {
    return warnings.size() == 1 && warnings[0].find(text) != std::string::npos;
  }
};

}  // namespace

TEST_CASE("LPIPS with AlexNet stands in where there is no VGG16, and the warning says so") {
  const LpipsWeightsHere weights;
  const Wanted wanted(scene_of(kWidth, kHeight));
  REQUIRE(wanted.loss != nullptr);
  CHECK(wanted.config.lambda_lpips > 0);
  CHECK(wanted.says("method: LPIPS is on: alex, sha256 "));
}

TEST_CASE("LPIPS is off for views too small for its network, without weights, and unasked") {
  {
    const LpipsWeightsHere weights;
    const Wanted small(scene_of(20, 20));
    CHECK(small.loss == nullptr);
    CHECK(small.config.lambda_lpips == 0);
    CHECK(small.says("method: LPIPS is off: first is too small"));
  }
  ::setenv("GLINT_LPIPS_WEIGHTS", "/no/such/folder", 1);
  const Wanted none(scene_of(kWidth, kHeight));
  CHECK(none.loss == nullptr);
  CHECK(none.says("method: LPIPS is off: no weights"));
  PerceptualConfig unasked;
  unasked.lambda_lpips = 0;
  CHECK(Wanted(scene_of(kWidth, kHeight), unasked).warnings.empty());
  ::unsetenv("GLINT_LPIPS_WEIGHTS");
}

TEST_CASE("LPIPS joins the loss when its iteration has come: value and gradient are the metric's") {
  const LpipsWeightsHere weights;
  PerceptualConfig config;
  config.lambda_lpips = 0.25f, config.lpips_from = 10;
  config.lpips_unit_range = GENERATE(false, true);
  const Wanted wanted(scene_of(kWidth, kHeight), config);
  const Image rendered = golden::prediction_image(kWidth, kHeight, 3);
  const Image target = golden::reference_image(kWidth, kHeight, 3);
  Image gradient(kWidth, kHeight, 3), expected(kWidth, kHeight, 3);
  StepStats stats;
  add_perceptual(wanted.loss.get(), config, 9, rendered, target, gradient, stats);
  CHECK(stats.terms.empty());
  add_perceptual(wanted.loss.get(), config, 10, rendered, target, gradient, stats);
  Lpips lpips(
      lpips_weights_at(weights.folder.path(), "alex"),
      config.lpips_unit_range ? LpipsRange::kUnit : LpipsRange::kSymmetric
  );
  const double value = lpips.evaluate(rendered, target, 0.25f, expected);
  CHECK(stats.terms.at("lpips") == Approx(0.25 * value).epsilon(1e-12));
  CHECK(std::equal(gradient.values().begin(), gradient.values().end(), expected.data()));
}

TEST_CASE("Photos of the scene are known when they come again; other targets are looked at anew") {
  const LpipsWeightsHere weights;
  Scene scene = scene_of(kWidth, kHeight);
  scene.train[0].rgb = golden::reference_image(kWidth, kHeight, 3);
  const Wanted wanted(scene);
  const Image rendered = golden::prediction_image(kWidth, kHeight, 3);
  Image other = scene.train[0].rgb;
  const auto evaluate = [&](const Image& target) {
    Image gradient(kWidth, kHeight, 3);
    const double loss = wanted.loss->evaluate(rendered, target, 1, gradient);
    return std::pair{loss, std::vector<float>(gradient.values().begin(), gradient.values().end())};
  };
  const auto first = evaluate(scene.train[0].rgb);
  CHECK(evaluate(other) == first);
  other.at(3, 4, 1) += 0.5f;
  CHECK(evaluate(other) != first);
  CHECK(evaluate(scene.train[0].rgb) == first);
}
