// SPDX-License-Identifier: MIT
#include "metrics/components.h"

#include <catch2/catch.hpp>

#include <limits>

#include "glint/core/error.h"
#include "metrics/metric.h"
#include "metrics/psnr.h"
#include "tests/metrics/golden_images.h"

using namespace glint;

namespace {

constexpr int kWidth = 8, kHeight = 4;

// Glass is the left half. Three quarters of the radiance came through it, in every channel; the
// method splits in halves.
struct Maps {
  Image displayed = Image(kWidth, kHeight, 3, 0.8f);
  Image true_transmitted = Image(kWidth, kHeight, 3, 6.0f);
  Image true_reflected = Image(kWidth, kHeight, 3, 2.0f);
  Image half = Image(kWidth, kHeight, 3, 0.4f);
  MaskImage glass = MaskImage(kWidth, kHeight, 1);

  Maps() {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth / 2; ++x) glass.at(x, y) = 255;
  }
  ViewPair pair() const {
    ViewPair pair;
    pair.truth["rgb"] = displayed;
    pair.rendered["transmitted"] = half, pair.rendered["reflected"] = half;
    pair.truth["transmitted"] = true_transmitted, pair.truth["reflected"] = true_reflected;
    pair.glass = glass;
    return pair;
  }
};

}  // namespace

TEST_CASE("a component is the displayed pixel times its share of the radiance, per channel") {
  Image displayed(1, 1, 3), component(1, 1, 3), other(1, 1, 3);
  for (int c = 0; c < 3; ++c) displayed.at(0, 0, c) = 0.5f;
  component.at(0, 0, 0) = 3, other.at(0, 0, 0) = 1;
  component.at(0, 0, 1) = 0, other.at(0, 0, 1) = 7;
  component.at(0, 0, 2) = 0.25f, other.at(0, 0, 2) = 0;
  const Image part = displayed_component(displayed, component, other);
  CHECK(part.at(0, 0, 0) == 0.375f);
  CHECK(part.at(0, 0, 1) == 0.0f);
  CHECK(part.at(0, 0, 2) == 0.5f);
}

TEST_CASE("without radiance both components are black") {
  const Image displayed(2, 2, 3, 0.5f), none(2, 2, 3);
  const Image part = displayed_component(displayed, none, none);
  for (const float value : part.values()) CHECK(value == 0.0f);
}

TEST_CASE("the two components add up to the displayed image") {
  const Image displayed = golden::reference_image(kWidth, kHeight, 3);
  const auto ramp = [](int step) {
    return golden::make_image(kWidth, kHeight, 3, [step](int x, int y, int c) {
      return 0.1f + 0.7f * static_cast<float>((3 * x + 5 * y + step * c) % 11);
    });
  };
  const Image first = displayed_component(displayed, ramp(2), ramp(3));
  const Image second = displayed_component(displayed, ramp(3), ramp(2));
  for (std::size_t i = 0; i < displayed.values().size(); ++i)
    CHECK(
        double(first.values()[i]) + double(second.values()[i]) ==
        Approx(double(displayed.values()[i])).margin(1e-7)
    );
}

TEST_CASE("a true part is one of those of its kind: the two components, or the paths") {
  const Maps maps;
  MapViews truth = maps.pair().truth;
  const auto part = [&](const char* id) {
    return displayed_part(maps.displayed, truth, *find_map(id));
  };
  CHECK(part("transmitted").at(1, 1, 1) == Approx(0.6f));
  CHECK(part("path_t").empty());
  for (const char* id : {"path_t", "path_tt", "path_r", "path_tr", "path_rt"})
    truth[*find_map(id)] = maps.true_reflected;
  CHECK(part("path_t").empty());  // how much came by other paths is not known
  truth["path_rest"] = maps.true_transmitted;
  CHECK(part("path_t").at(1, 1, 1) == Approx(0.8f * 2 / 16));
  CHECK(part("transmitted").at(1, 1, 1) == Approx(0.6f));
  truth["reflected"] = {};
  CHECK(part("transmitted").empty());
}

TEST_CASE("components are scored on glass pixels in closed form") {
  // Truth 0.6 and 0.2, prediction 0.4 twice: an error of 0.2, that is -20 log10(0.2) dB.
  Maps maps;
  for (int y = 0; y < kHeight; ++y)
    for (int x = kWidth / 2; x < kWidth; ++x) maps.half.at(x, y) = 1;  // no glass: does not count
  const auto scores = evaluate_view(maps.pair());
  CHECK(scores.at("trans-psnr") == Approx(-20 * std::log10(0.2)).epsilon(1e-6));
  CHECK(scores.at("refl-psnr") == Approx(-20 * std::log10(0.2)).epsilon(1e-6));
  CHECK(scores.count("trans-psnr@glass") == 0);
  CHECK(scores.count("refl-psnr@opaque") == 0);
}

TEST_CASE("true components as a prediction reach the cap, and predictions are clamped") {
  Maps maps;
  ViewPair pair = maps.pair();
  const Image exact =
      displayed_component(maps.displayed, maps.true_transmitted, maps.true_reflected);
  pair.rendered["transmitted"] = exact;
  CHECK(evaluate_view(pair).at("trans-psnr") == kPsnrCapDb);
  maps.displayed = Image(kWidth, kHeight, 3, 1.0f);
  maps.true_reflected = Image(kWidth, kHeight, 3);
  maps.half = Image(kWidth, kHeight, 3, 1.7f);
  CHECK(evaluate_view(maps.pair()).at("trans-psnr") == kPsnrCapDb);
}

TEST_CASE("a component without its layer, its truth or any glass is absent") {
  const Maps maps;
  ViewPair one_layer = maps.pair();
  one_layer.rendered["transmitted"] = {};
  CHECK(evaluate_view(one_layer).count("trans-psnr") == 0);
  CHECK(evaluate_view(one_layer).count("refl-psnr") == 1);
  ViewPair no_truth = maps.pair();
  no_truth.truth["reflected"] = {};
  CHECK(evaluate_view(no_truth).empty());
  const MaskImage no_glass(kWidth, kHeight, 1);
  for (const MaskView glass : {MaskView(no_glass), MaskView{}}) {
    ViewPair pair = maps.pair();
    pair.glass = glass;
    CHECK(evaluate_view(pair).empty());
  }
}

TEST_CASE("radiance of another size, negative or not finite is an error of the reference") {
  const Image displayed(3, 2, 3, 0.5f), good(3, 2, 3, 1.0f);
  const auto fails = [&](const Image& component, const char* message) {
    CHECK_THROWS_WITH(displayed_component(displayed, component, good), Catch::Contains(message));
    CHECK_THROWS_WITH(displayed_component(displayed, good, component), Catch::Contains(message));
  };
  fails(Image(2, 2, 3), "2 x 2");
  fails(Image(3, 2, 1), "1 channels");
  Image bad = good;
  bad.at(2, 1, 1) = -0.5f;
  fails(bad, "-0.5 at pixel (2, 1)");
  bad.at(2, 1, 1) = std::numeric_limits<float>::infinity();
  fails(bad, "inf at pixel (2, 1)");
}
