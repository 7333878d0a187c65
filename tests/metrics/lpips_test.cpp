// SPDX-License-Identifier: MIT
#include "metrics/lpips.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "glint/core/parallel.h"
#include "glint/scene/image_files.h"
#include "tests/metrics/golden_images.h"
#include "tests/metrics/tiny_lpips.h"
#include "tests/support/gradcheck.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

// Sizes at which a pooling of the tiny network leaves pixels over.
constexpr int kWidth = 31, kHeight = 26;

const LpipsArrays& tiny_arrays() {
  static const LpipsArrays arrays = random_arrays(tiny_network());
  return arrays;
}

Lpips tiny_lpips(LpipsRange range = LpipsRange::kSymmetric) {
  return Lpips(
      std::make_shared<const LpipsWeights>(make_lpips_weights(tiny_network(), tiny_arrays(), "tiny")
      ),
      range
  );
}

Image prediction(int width = kWidth, int height = kHeight) {
  return golden::prediction_image(width, height, 3);
}
Image reference(int width = kWidth, int height = kHeight) {
  return golden::reference_image(width, height, 3);
}

Features doubles(const Image& image) {
  Features result(image.width(), image.height(), image.channels());
  std::copy(image.values().begin(), image.values().end(), result.data());
  return result;
}

double plain_distance(const Image& a, const Image& b) {
  return PlainLpips(tiny_network(), tiny_arrays()).distance(doubles(a), doubles(b));
}

MaskImage columns(int begin, int end) {
  MaskImage mask(kWidth, kHeight, 1);
  for (int y = 0; y < kHeight; ++y)
    for (int x = begin; x < end; ++x) mask.at(x, y) = 255;
  return mask;
}

Image gradient_of(Lpips& lpips, float weight = 1) {
  Image gradient(kWidth, kHeight, 3);
  lpips.evaluate(prediction(), reference(), weight, gradient);
  return gradient;
}

}  // namespace

TEST_CASE("LPIPS agrees with plain loops over every kind of layer") {
  Lpips lpips = tiny_lpips();
  const double expected = plain_distance(prediction(), reference());
  REQUIRE(expected > 0.01);
  CHECK(lpips.distance(prediction(), reference()) == Approx(expected).epsilon(1e-5));
}

TEST_CASE("LPIPS of an image with itself is 0, and it is symmetric") {
  Lpips lpips = tiny_lpips();
  CHECK(lpips.distance(reference(), reference()) == 0);
  const double there = lpips.distance(prediction(), reference());
  CHECK(lpips.distance(reference(), prediction()) == Approx(there).epsilon(1e-12));
}

TEST_CASE("LPIPS clamps the prediction, and the range changes the value") {
  Lpips lpips = tiny_lpips(), unit = tiny_lpips(LpipsRange::kUnit);
  Image bright = prediction(), clamped = prediction();
  bright.at(3, 4, 1) = 7, clamped.at(3, 4, 1) = 1;
  CHECK(lpips.distance(bright, reference()) == lpips.distance(clamped, reference()));
  CHECK(
      std::abs(unit.distance(clamped, reference()) - lpips.distance(clamped, reference())) > 1e-4
  );
}

TEST_CASE("LPIPS has the same bytes for any number of threads, forwards and backwards") {
  Lpips lpips = tiny_lpips();
  std::vector<double> distances;
  std::vector<std::vector<float>> gradients;
  for (const int threads : {1, 2, 5}) {
    set_num_threads(threads);
    distances.push_back(lpips.distance(prediction(), reference()));
    const Image gradient = gradient_of(lpips);
    gradients.emplace_back(gradient.values().begin(), gradient.values().end());
  }
  set_num_threads(0);
  for (const double distance : distances) CHECK(distance == distances[0]);
  for (const auto& gradient : gradients) CHECK(gradient == gradients[0]);
}

TEST_CASE("LPIPS follows the size of its images") {
  Lpips lpips = tiny_lpips();
  const double small = lpips.distance(prediction(), reference());
  const double large = lpips.distance(prediction(50, 40), reference(50, 40));
  CHECK(large == Approx(plain_distance(prediction(50, 40), reference(50, 40))).epsilon(1e-5));
  CHECK(lpips.distance(prediction(), reference()) == small);
}

TEST_CASE("The gradient of LPIPS is that of plain loops by central differences") {
  Lpips lpips = tiny_lpips();
  const Image gradient = gradient_of(lpips);
  const PlainLpips plain(tiny_network(), tiny_arrays());
  const Features target = doubles(reference());
  Features image = doubles(prediction());
  std::vector<float> actual;
  std::vector<double> expected;
  // Small steps: ReLU and pooling have kinks.
  constexpr double kStep = 1e-6;
  for (std::size_t i = 0; i < gradient.values().size(); i += 13) {
    const double value = image.data()[i];
    image.data()[i] = value + kStep;
    const double above = plain.distance(image, target);
    image.data()[i] = value - kStep;
    const double below = plain.distance(image, target);
    image.data()[i] = value;
    actual.push_back(gradient.data()[i]);
    expected.push_back((above - below) / (2 * kStep));
  }
  const GradientError error = gradient_error<float>(actual, expected);
  REQUIRE(error.norm > 1e-3);
  CHECK(error.distance <= 1e-3 * error.norm);
}

TEST_CASE("As a loss LPIPS returns the unweighted distance and adds the weighted gradient") {
  Lpips lpips = tiny_lpips();
  const Image one = gradient_of(lpips, 1);
  Image gradient(kWidth, kHeight, 3, 10.0f);
  const double loss = lpips.evaluate(prediction(), reference(), 0.5f, gradient);
  CHECK(loss == lpips.distance(prediction(), reference()));
  for (std::size_t i = 0; i < one.values().size(); ++i)
    CHECK(gradient.data()[i] == Approx(10.0f + 0.5f * one.data()[i]).epsilon(1e-6));
}

TEST_CASE("A mask of all pixels gives the mean of the map, and halves average to it") {
  Lpips lpips = tiny_lpips();
  const MaskImage left = columns(0, 16), right = columns(16, kWidth), all = columns(0, kWidth);
  const auto masked = [&](const MaskImage& mask) {
    return lpips.distance(prediction(), reference(), mask);
  };
  CHECK(masked(left) != masked(right));
  CHECK(
      (16 * masked(left) + (kWidth - 16) * masked(right)) / kWidth ==
      Approx(masked(all)).epsilon(1e-12)
  );
  CHECK(masked(all) == Approx(lpips.distance(prediction(), reference())).epsilon(0.1));
  CHECK_THROWS_AS(masked(columns(0, 0)), Error);
}

TEST_CASE("Enlarging is bilinear between the centres of positions, constant beyond the last") {
  LpipsMap tap(2, 1, 1);
  tap.at(0, 0) = 1, tap.at(1, 0) = 3;
  const LpipsMap map = lpips_map({tap, tap}, {4, 2});
  const double expected[] = {2 * 1, 2 * 1.5, 2 * 2.5, 2 * 3};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) CHECK(map.at(x, y) == expected[x]);
  CHECK(lpips_mean({tap, tap}) == 4);
}

TEST_CASE("Images that LPIPS cannot compare are errors") {
  Lpips lpips = tiny_lpips();
  CHECK_THROWS_AS(lpips.distance(prediction(40, 26), reference()), Error);
  CHECK_THROWS_AS(
      lpips.distance(golden::prediction_image(31, 26, 1), golden::reference_image(31, 26, 1)), Error
  );
  Image bad = prediction();
  bad.at(2, 3, 1) = NAN;
  const std::string message =
      error_of(ExitCode::kBadPrediction, [&] { lpips.distance(bad, reference()); });
  CHECK(message.find("pixel (2, 3)") != std::string::npos);
  const std::string small =
      bad_reference([&] { lpips.distance(prediction(9, 9), reference(9, 9)); });
  CHECK(small.find("too small for LPIPS") != std::string::npos);
  CHECK_FALSE(lpips.accepts({9, 9}));
  CHECK(lpips.accepts({kWidth, kHeight}));
}

TEST_CASE("LPIPS of real image pairs agrees with the published code, tap by tap") {
  const fs::path data = "../shared/data";
  const TempFolder folder;
  const std::string convert = fmt::format(
      "scripts/convert_lpips_weights.py --npz {} --out {} > /dev/null",
      (data / "lpips/lpips_alex_v0.1.npz").string(),
      folder.path().string()
  );
  if (!fs::exists(data / "metric_pairs/image_metrics.json") || std::system(convert.c_str()) != 0) {
    WARN("skipped: " << data << " or python3 is absent");
    return;
  }
  const auto weights = lpips_weights_at(folder.path(), "alex");
  REQUIRE(weights != nullptr);
  CHECK(weights->version == "0.1");
  Lpips lpips(weights), unit(weights, LpipsRange::kUnit);
  for (const Json& pair : Json::parse(read_file(data / "metric_pairs/image_metrics.json"))) {
    const fs::path images = data / "metric_pairs/images";
    const Image test = read_image(images / pair["test"].get<std::string>(), 3);
    const Image ref = read_image(images / pair["ref"].get<std::string>(), 3);
    CAPTURE(pair["test"]);
    const std::vector<LpipsMap> taps = lpips.tap_maps(test, ref);
    const auto published = [](const Json& value) {
      return Approx(value.get<double>()).margin(1e-5).epsilon(0);
    };
    CHECK(lpips_mean(taps) == published(pair["lpips_alex"]));
    CHECK(unit.distance(test, ref) == published(pair["lpips_alex_input01"]));
    for (std::size_t i = 0; i < taps.size(); ++i)
      CHECK(lpips_mean({taps[i]}) == published(pair["lpips_alex_layers"][i]));
  }
}

// The network in which the papers report is nowhere in the project's data: whoever has its weights
// can check them against a published value.
TEST_CASE("LPIPS with VGG16 agrees with the published code where its weights are given") {
  const fs::path pair = "../shared/data/lpips/vgg_reference";
  const auto weights = lpips_weights_at(lpips_weights_place(), "vgg");
  if (!fs::exists(pair) || weights == nullptr) {
    WARN("skipped: no VGG16 weights at " << lpips_weights_place() << " or no " << pair);
    return;
  }
  Lpips lpips(weights);
  const Image apple = read_image(pair / "apple.png", 3), pear = read_image(pair / "pear.png", 3);
  CHECK(lpips.distance(apple, pear) == Approx(0.6571020).margin(1e-4));
}
