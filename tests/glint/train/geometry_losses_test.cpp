// SPDX-License-Identifier: MIT
#include "glint/train/geometry_losses.h"

#include <catch2/catch.hpp>

#include "glint/render/map_ops.h"
#include "tests/support/random_scene.h"
#include "tests/support/random_values.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{12, 9};

struct Fixture {
  Scene scene;
  RasterOutput output;
  Image depth;

  Fixture() {
    Rng rng(5);
    View view;
    view.camera = random_camera(rng, kSize);
    view.rgb = random_map(rng, kSize, 3, 0, 1);
    view.priors["depth"] = random_map(rng, kSize, 1, 1, 2);
    view.priors["normal"] = random_map(rng, kSize, 3, -1, 1);
    scene.name = "test";
    scene.train = {view};
    output.alpha = random_map(rng, kSize, 1, 0.5f, 1);
    output.depth_sum = random_map(rng, kSize, 1, 1, 2);
    output.normal = random_map(rng, kSize, 3, -1, 1);
    expected_depth_map(output, depth);
  }
  // Terms at an iteration, and the gradient.
  StepStats terms(const GeometryLossConfig& config, int iteration, RasterOutputGradient& g) {
    GeometryLosses losses;
    CHECK(losses.set_up(config, scene, "test").empty());
    clear_gradient(kSize, 3, g);
    StepStats stats;
    losses.add(scene.train.front(), iteration, output, depth, g, stats);
    return stats;
  }
};

double norm(const Image& image) {
  double sum = 0;
  for (const float value : image.values()) sum += static_cast<double>(value * value);
  return sum;
}

}  // namespace

TEST_CASE("Each loss on the maps counts from its iteration on, with its weight") {
  Fixture f;
  RasterOutputGradient g;
  GeometryLossConfig config;
  CHECK(f.terms(config, 100000, g).terms.empty());
  CHECK(norm(g.normal) + norm(g.alpha) + norm(g.depth_sum) == 0);
  config.lambda_depth = config.lambda_normal = config.lambda_consistency = config.lambda_smooth =
      0.5f;
  config.consistency_from = 20;
  config.smooth_from = 30;
  CHECK(f.terms(config, 10, g).terms.size() == 2);
  CHECK(f.terms(config, 20, g).terms.size() == 3);
  const auto half = f.terms(config, 30, g).terms;
  REQUIRE(half.size() == 4);
  config.lambda_depth = config.lambda_normal = config.lambda_consistency = config.lambda_smooth = 1;
  for (const auto& [name, value] : f.terms(config, 30, g).terms)
    CHECK(value == Approx(2 * half.at(name)));
}

TEST_CASE("The depth prior reaches both the depth sum and alpha, the normal prior the normal") {
  Fixture f;
  RasterOutputGradient g;
  GeometryLossConfig config;
  config.lambda_depth = 1;
  f.terms(config, 0, g);
  CHECK(norm(g.depth_sum) > 0);
  CHECK(norm(g.alpha) > 0);
  CHECK(norm(g.normal) == 0);
  config.lambda_depth = 0;
  config.lambda_normal = 1;
  f.terms(config, 0, g);
  CHECK(norm(g.depth_sum) == 0);
  CHECK(norm(g.normal) > 0);
}

TEST_CASE("The gate of the normal prior closes at its iteration") {
  Fixture f;
  RasterOutputGradient g;
  GeometryLossConfig config;
  config.lambda_normal = 1;
  config.gate_from = 50;
  const double open = f.terms(config, 49, g).terms.at("normal");
  CHECK(f.terms(config, 50, g).terms.at("normal") < open);
}

TEST_CASE("Losses on the median depth reach it, and neither the depth sum nor alpha") {
  Fixture f;
  GeometryLossConfig config;
  config.lambda_depth = config.lambda_consistency = 1;
  GeometryLosses losses;
  losses.set_up(config, f.scene, "test");
  RasterOutputGradient expected, median;
  StepStats a, b;
  clear_gradient(kSize, 3, expected);
  clear_gradient(kSize, 3, median);
  losses.add(f.scene.train.front(), 0, f.output, f.depth, expected, a);
  losses.add(
      f.scene.train.front(), 0, f.output, f.depth, median, b, LossDepth::kMedian
  );  // the same depth
  CHECK(a.terms == b.terms);
  CHECK(norm(median.depth_sum) + norm(median.alpha) == 0);
  CHECK(expected.depth_median.empty());
  // What reaches the depth sum is dL/d(depth) / alpha.
  for (std::size_t i = 0; i < kSize.num_pixels(); ++i)
    CHECK(
        median.depth_median.data()[i] ==
        Approx(expected.depth_sum.data()[i] * f.output.alpha.data()[i]).margin(1e-6)
    );
}

TEST_CASE("Consistency weighs near pixels more where it is asked to") {
  Fixture f;
  RasterOutputGradient g;
  GeometryLossConfig config;
  config.lambda_consistency = 1;
  const double all = f.terms(config, 0, g).terms.at("consistency");
  config.near_consistency = true;
  const double near = f.terms(config, 0, g).terms.at("consistency");
  Image dL_dn(kSize.width, kSize.height, 3), dL_dz(kSize.width, kSize.height, 1);
  CHECK(
      near == Approx(NormalConsistencyLoss().evaluate(
                  f.scene.train.front().camera,
                  f.output.normal,
                  f.depth,
                  f.output.alpha,
                  1,
                  dL_dn,
                  dL_dz,
                  inverse_depth_weight(f.depth)
              ))
  );
  CHECK(near != all);
}

TEST_CASE("A loss is off at views that lack its prior, with a warning") {
  Fixture f;
  f.scene.train.push_back(f.scene.train.front());
  f.scene.train.back().priors["depth"] = {};
  GeometryLossConfig config;
  config.lambda_depth = config.lambda_normal = 1;
  GeometryLosses losses;
  const auto warnings = [&] { return losses.set_up(config, f.scene, "test"); };
  const auto terms_of = [&](const View& view) {
    RasterOutputGradient g;
    clear_gradient(kSize, 3, g);
    StepStats stats;
    losses.add(view, 0, f.output, f.depth, g, stats);
    CHECK((norm(g.depth_sum) > 0) == (stats.terms.count("depth") == 1));
    CHECK((norm(g.normal) > 0) == (stats.terms.count("normal") == 1));
    return stats.terms;
  };
  using Lines = std::vector<std::string>;
  CHECK(
      warnings() ==
      Lines{"test: test has no depth prior for 1 of 2 training views; L_depth is off there"}
  );
  CHECK(terms_of(f.scene.train.front()).size() == 2);
  CHECK(terms_of(f.scene.train.back()).count("depth") == 0);
  CHECK(terms_of(f.scene.train.back()).count("normal") == 1);
  f.scene.train.front().priors["depth"] = {};
  CHECK(
      warnings() == Lines{"test: test has no depth prior for 2 of 2 training views; L_depth is off"}
  );
  CHECK_FALSE(terms_of(f.scene.train.front()).contains("depth"));
}

TEST_CASE("The control of a baseline has GLINT's priors and smoothness at the same share of its run"
) {
  GeometryLossConfig config;
  config.use_priors(30000);
  CHECK(config.lambda_depth == PriorLosses::kLambdaDepth);
  CHECK(config.lambda_normal == PriorLosses::kLambdaNormal);
  CHECK(config.gate_from == 5000);
  CHECK(config.lambda_smooth == PriorLosses::kLambdaSmooth);
  CHECK(config.smooth_from == 2500);
}
