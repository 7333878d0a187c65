// SPDX-License-Identifier: MIT
#include "glint/train/transmission_losses.h"

#include <catch2/catch.hpp>

#include "glint/core/error.h"
#include "glint/render/map_ops.h"
#include "tests/support/random_scene.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{12, 9};
constexpr PhotometricWeights kWeights{0.8f, 0.2f};

Image constant(int channels, float value) {
  return Image(kSize.width, kSize.height, channels, value);
}

// A wall two metres away as interface, t = 0.5 everywhere; a transmission wall at `behind` metres.
struct Fixture {
  Scene scene;
  RasterOutput interface;
  GlassBuffer buffer;
  TrainableSet transmission;
  Image dL_dtransparency = constant(1, 0);

  explicit Fixture(float behind = 3) {
    View view;
    view.camera = look_at({0, 0, 0}, {0, 0, 1}, {0, -1, 0}, kSize, 60);
    view.rgb = constant(3, 0.3f);
    view.priors["albedo"] = constant(3, 0.01f);
    scene.name = "test";
    scene.train = {view};
    interface.normal = constant(3, 0);
    for (std::size_t i = 0; i < kSize.num_pixels(); ++i) interface.normal.data()[3 * i + 2] = -1;
    buffer.depth = constant(1, 2);
    buffer.transparency = constant(1, 0.5f);
    SurfelCloud wall;
    wall.resize(1);
    wall.means = {0, 0, behind};
    wall.log_scales = {3, 3};
    wall.rotations = {1, 0, 0, 0};
    wall.opacity_logits = {3};
    transmission = TrainableSet(wall, SetTraining{});
  }
  // behind: see TransmissionLosses::add(); mirrors: of leave_out().
  StepStats add(
      const TransmissionLossConfig& config,
      int iteration,
      RasterPass* behind = nullptr,
      const Image* mirrors = nullptr
  ) {
    TransmissionLosses losses;
    CHECK(losses.set_up(config, scene, "test").empty());
    losses.leave_out(mirrors);
    StepStats stats;
    losses.add(
        scene.train[0],
        iteration,
        0,
        kWeights,
        interface,
        buffer,
        transmission,
        behind,
        dL_dtransparency,
        stats
    );
    return stats;
  }
};

double norm(std::span<const float> values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value * value);
  return sum;
}

// 0.5 x the mean of a picture.
struct MeanBrightness final : PerceptualLoss {
  bool accepts(ImageSize) const override { return true; }
  double evaluate_all(const Image& rendered, const Image&, float weight, Image& dL_drendered)
      override {
    double sum = 0;
    const auto count = static_cast<double>(rendered.values().size());
    for (std::size_t i = 0; i < rendered.values().size(); ++i) {
      sum += static_cast<double>(rendered.data()[i]);
      dL_drendered.data()[i] += 0.5f * weight / static_cast<float>(count);
    }
    return 0.5 * sum / count;
  }
};

TransmissionLossConfig only_guidance() {
  TransmissionLossConfig config;
  config.transparency_from = 10;
  return config;
}

}  // namespace

TEST_CASE("Guidance draws t to 1 where the layers lie apart, from its iteration on") {
  Fixture f;
  CHECK(f.add(only_guidance(), 9).terms.empty());
  const StepStats stats = f.add(only_guidance(), 10);
  CHECK(stats.terms.at("transparency") == Approx(0.1 * 0.5));
  CHECK(f.dL_dtransparency.at(6, 4) < 0);
  CHECK(norm(f.transmission.gradient().means) == 0);  // the depths are constants
}

TEST_CASE("Guidance is what labels of the whole set make of it, also where few pixels are dark") {
  Fixture f, whole;
  for (Fixture* fixture : {&f, &whole})
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 2; x < kSize.width; ++x)
        std::fill_n(fixture->scene.train[0].priors["albedo"].pixel(x, y), 3, 0.5f);
  const View& view = whole.scene.train[0];
  const RasterOutput& out = whole.transmission.forward(view.camera, 0);
  Image depth;
  expected_depth_map(out, depth);
  const TransparencyGuidance guidance = TransparencyGuidance::paper();
  const TransparencyMasks masks =
      guidance.masks({whole.buffer.depth, depth, view.priors["albedo"], {}, {}});
  CHECK(masks.transparent.at(1, 4) == 1.0f);
  CHECK(masks.transparent.at(2, 4) == 0.0f);
  guidance.evaluate(whole.buffer.transparency, masks, 0.1f, whole.dL_dtransparency);
  RasterPass& behind = f.transmission.pass();
  f.transmission.forward(view.camera, 0);
  f.add(only_guidance(), 10, &behind);
  CHECK(f.dL_dtransparency.array() == whole.dL_dtransparency.array());
}

TEST_CASE("Only the paper's labels do without depths, where the albedo is not low") {
  Image albedo(2, 1, 3, 0.02f), needed;
  std::fill_n(albedo.pixel(1, 0), 3, 0.05f);
  TransparencyGuidance::paper().mark_needed_depths(albedo, needed);
  CHECK(needed.at(0, 0) == 1.0f);
  CHECK(needed.at(1, 0) == 0.0f);
  TransparencyGuidance::release().mark_needed_depths(albedo, needed);
  CHECK(needed.empty());
}

TEST_CASE("Guidance draws t to 0 where the layers coincide") {
  Fixture f(2);
  f.add(only_guidance(), 10);
  CHECK(f.dL_dtransparency.at(6, 4) > 0);
}

TEST_CASE("Direct supervision is the photometric loss of the set on its own, times its weight") {
  Fixture f;
  TransmissionLossConfig config;
  config.lambda_transparency = 0;
  config.lambda_direct = 2;
  const StepStats stats = f.add(config, 0);
  PhotometricLoss loss;
  RasterOutputGradient g;
  clear_gradient(kSize, 3, g);
  Fixture other;
  const RasterOutput& out = other.transmission.forward(other.scene.train[0].camera, 0);
  const PhotometricWeights doubled{1.6f, 0.4f};
  const double expected =
      loss.evaluate(out.features, other.scene.train[0].rgb, doubled, g.features).weighted(doubled);
  other.transmission.backward(g);
  CHECK(stats.terms.at("direct") == Approx(expected));
  CHECK(norm(f.transmission.gradient().sh_dc) > 0);
  CHECK(f.transmission.gradient().sh_dc == other.transmission.gradient().sh_dc);
}

TEST_CASE("Pixels that show a mirror do not count for the set on its own") {
  TransmissionLossConfig config;
  config.lambda_transparency = 0;
  config.lambda_direct = 2;
  Image mirrors = constant(1, 0), others = constant(1, 1);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < 5; ++x) mirrors.at(x, y) = 1, others.at(x, y) = 0;
  Fixture all, masked, with_mirrors;
  for (Fixture* f : {&all, &masked, &with_mirrors})
    for (int y = 0; y < kSize.height; ++y) f->scene.train[0].rgb.at(1, y, 0) = 1;
  masked.scene.train[0].counted = others;
  const double expected = masked.add(config, 0).terms.at("direct");
  CHECK(with_mirrors.add(config, 0, nullptr, &mirrors).terms.at("direct") == expected);
  CHECK(with_mirrors.transmission.gradient().sh_dc == masked.transmission.gradient().sh_dc);
  CHECK(all.add(config, 0).terms.at("direct") != expected);
  with_mirrors.scene.train[0].counted = others;  // both
  CHECK(with_mirrors.add(config, 0, nullptr, &mirrors).terms.at("direct") == expected);
}

TEST_CASE("The set on its own has consistent normals") {
  Fixture f;
  TransmissionLossConfig config;
  config.lambda_transparency = 0;
  config.lambda_direct_consistency = 2;
  config.direct_near_consistency = false;
  const StepStats stats = f.add(config, 5);
  REQUIRE(stats.terms.size() == 1);
  // Border pixels count as 1; inside, the normals differ by what alpha lacks to 1.
  const double border = 1 - 10.0 * 7 / static_cast<double>(kSize.num_pixels());
  CHECK(stats.terms.at("direct consistency") > 2 * border);
  CHECK(stats.terms.at("direct consistency") < 2 * (border + 0.2));
  CHECK(norm(f.transmission.gradient().opacity_logits) > 0);
}

TEST_CASE("The set on its own shares the work of the pass behind the interface, to the same end") {
  TransmissionLossConfig config = only_guidance();
  config.lambda_direct = 2;
  Fixture alone, shared;
  const Camera& camera = shared.scene.train[0].camera;
  const StepStats expected = alone.add(config, 10);
  const Image near(kSize.width, kSize.height, 1, 5.0f);  // hides the wall
  const RasterOutput& behind = shared.transmission.forward(camera, 0, {}, near);
  CHECK(norm(behind.alpha.values()) == 0);
  const StepStats stats = shared.add(config, 10, &shared.transmission.pass());
  CHECK(stats.terms == expected.terms);
  CHECK(shared.transmission.gradient().means == alone.transmission.gradient().means);
  CHECK(shared.transmission.gradient().sh_dc == alone.transmission.gradient().sh_dc);
}

TEST_CASE("LPIPS of the set on its own is that of the interface's picture") {
  MeanBrightness loss;
  PerceptualConfig perceptual;
  perceptual.lambda_lpips = 4;
  perceptual.lpips_from = 3;
  for (const bool wanted : {false, true}) {
    Fixture f;
    TransmissionLossConfig config;
    config.lambda_transparency = 0;
    config.lambda_direct = 1;
    config.direct_lpips = wanted;
    TransmissionLosses losses;
    losses.set_up(config, f.scene, "test");
    losses.use_perceptual(&loss, perceptual);
    const auto terms_at = [&](int iteration) {
      StepStats stats;
      losses.add(
          f.scene.train[0],
          iteration,
          0,
          kWeights,
          f.interface,
          f.buffer,
          f.transmission,
          nullptr,
          f.dL_dtransparency,
          stats
      );
      return stats.terms;
    };
    CHECK(terms_at(2).count("direct lpips") == 0);
    CHECK((terms_at(3).count("direct lpips") == 1) == wanted);
    if (!wanted) continue;
    const RasterOutput& out = f.transmission.forward(f.scene.train[0].camera, 0);
    Image gradient(kSize.width, kSize.height, 3);
    CHECK(
        terms_at(3).at("direct lpips") ==
        Approx(4 * loss.evaluate(out.features, Image(), 0, gradient))
    );
  }
}

TEST_CASE("Plausibility moves the set to the interface where it is opaque, and only there") {
  for (const bool opaque : {false, true}) {
    Fixture f(2.5f);
    View& view = f.scene.train[0];
    view.priors["basecolor"] = constant(3, 0.5f);
    view.priors["albedo"] = constant(3, opaque ? 0.5f : 0.01f);
    view.priors["normal"] = constant(3, 0);
    for (std::size_t i = 0; i < kSize.num_pixels(); ++i)
      view.priors["normal"].data()[3 * i] = -1;  // across
    for (std::size_t i = 0; i < kSize.num_pixels(); ++i)
      f.buffer.depth.data()[i] = 1.8f + 0.01f * static_cast<float>(i % 12);
    TransmissionLossConfig config;
    config.guidance = "release";
    config.lambda_transparency = 0;
    config.lambda_plausible = 1;
    config.plausible_from = 0;
    const StepStats stats = f.add(config, 0);
    CHECK((stats.terms.at("plausible") > 0) == opaque);
    CHECK((norm(f.transmission.gradient().rotations) > 0) == opaque);
  }
}

TEST_CASE("The prior on t needs no rasterisation of the set") {
  Fixture f;
  TransmissionLossConfig config;
  config.lambda_transparency = 0;
  config.lambda_transparency_prior = 1;
  config.transparency_prior_from = 0;
  const StepStats stats = f.add(config, 0);
  CHECK(stats.terms.at("transparency prior") == Approx(std::log(2.0) + 0.5));
}

TEST_CASE("A view without priors guides nothing, and others go on") {
  Fixture f;
  f.scene.train.push_back(f.scene.train[0]);
  f.scene.train[0].priors = {};
  TransmissionLosses losses;
  CHECK(losses.set_up(only_guidance(), f.scene, "test").size() == 1);
  const auto terms_of = [&](const View& view) {
    StepStats stats;
    losses.add(
        view,
        10,
        0,
        kWeights,
        f.interface,
        f.buffer,
        f.transmission,
        nullptr,
        f.dL_dtransparency,
        stats
    );
    return stats.terms;
  };
  CHECK(terms_of(f.scene.train[0]).empty());
  CHECK(norm(f.dL_dtransparency.values()) == 0);
  CHECK(terms_of(f.scene.train[1]).contains("transparency"));
  CHECK(norm(f.dL_dtransparency.values()) > 0);
}

TEST_CASE("Guidance is off, with a warning, where a view lacks the prior it needs") {
  Fixture f;
  TransmissionLossConfig config;
  config.guidance = "release";
  TransmissionLosses losses;
  const auto warnings = losses.set_up(config, f.scene, "test");
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Catch::Contains("no basecolor prior"));
  f.scene.train.push_back(f.scene.train[0]);
  f.scene.train.back().priors["basecolor"] = constant(3, 0.5f);
  CHECK_THAT(
      losses.set_up(config, f.scene, "test").at(0),
      Catch::Contains("no basecolor prior for 1 of 2 training views; L_trans is off there")
  );
  config.guidance = "sideways";
  CHECK_THROWS_WITH(losses.set_up(config, f.scene, "test"), Catch::Contains("sideways"));
}

TEST_CASE("Where masks show that too little glass is dark, a warning says that t will be lost") {
  Fixture f;
  View& view = f.scene.train[0];
  view.truth["glass"] = constant(1, 1);
  for (int i = 0; i < 60; ++i)  // of 108
    for (std::size_t c = 0; c < 3; ++c) view.priors["albedo"].data()[3 * i + c] = 0.3f;
  TransmissionLossConfig config = only_guidance();
  TransmissionLosses losses;
  const auto warnings = losses.set_up(config, f.scene, "test");
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Catch::Contains("44 %") && Catch::Contains("more than 50 %"));
  config.transparent_weight = 4;  // asks for a fifth
  CHECK(losses.set_up(config, f.scene, "test").empty());
  config.low_albedo = 0.001f;  // who asks for a fifth already is not told to
  CHECK_THAT(
      losses.set_up(config, f.scene, "test").at(0),
      Catch::Contains("a larger transparent_weight") && !Catch::Contains("glint/robust")
  );
  config.transparent_weight = 1;
  config.low_albedo = 0.5f;
  CHECK(losses.set_up(config, f.scene, "test").empty());
  config = {};
  config.lambda_transparency = 0;
  CHECK(losses.set_up(config, f.scene, "test").empty());
  config.transparent_weight = -1;
  CHECK_THROWS_WITH(
      losses.set_up(config, f.scene, "test"), Catch::Contains("transparent_weight is -1")
  );
}
