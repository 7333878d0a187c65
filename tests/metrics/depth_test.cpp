// SPDX-License-Identifier: MIT
#include "metrics/depth.h"

#include <catch2/catch.hpp>

#include "glint/core/error.h"
#include "tests/metrics/golden_images.h"

using namespace glint;

namespace {

DepthProtocol aligned(DepthAlignment alignment) {
  DepthProtocol protocol;
  protocol.alignment = alignment;
  return protocol;
}

}  // namespace

TEST_CASE("a depth 10 percent too large has AbsRel 0.1 and is within delta") {
  const Image reference(6, 4, 1, 2.0f), prediction(6, 4, 1, 2.2f);
  const auto errors = depth_errors(prediction, reference);
  REQUIRE(errors);
  CHECK(errors->absrel == Approx(0.1).epsilon(1e-6));  // 2.2f is not 2.2
  CHECK(errors->rmse == Approx(0.2).epsilon(1e-6));
  CHECK(errors->delta1 == 100);
  CHECK(errors->coverage == 100);
  CHECK(errors->num_pixels == 24);
}

TEST_CASE("delta is strictly below its threshold, in both directions") {
  const auto delta1 = [](float predicted, float truth) {
    return depth_errors(Image(1, 1, 1, predicted), Image(1, 1, 1, truth))->delta1;
  };
  CHECK(delta1(5.0f, 4.0f) == 0);
  CHECK(delta1(4.99f, 4.0f) == 100);
  CHECK(delta1(4.0f, 5.0f) == 0);
  CHECK(delta1(4.01f, 5.0f) == 100);
}

TEST_CASE("a missing prediction counts with the whole depth and as wrong") {
  const Image reference(4, 1, 1, 3.0f);
  Image prediction = reference;
  prediction.at(0, 0) = 0;
  prediction.at(1, 0) = std::numeric_limits<float>::infinity();
  prediction.at(2, 0) = -1;
  const auto errors = depth_errors(prediction, reference);
  CHECK(errors->absrel == 0.75);
  CHECK(errors->rmse == Approx(std::sqrt(27.0 / 4)).epsilon(1e-15));
  CHECK(errors->delta1 == 25);
  CHECK(errors->coverage == 25);
}

TEST_CASE("pixels without reference depth or outside the mask do not count") {
  Image reference(3, 1, 1, 2.0f);
  reference.at(0, 0) = 0;
  MaskImage mask(3, 1, 1, 1);
  mask.at(1, 0) = 0;
  Image prediction(3, 1, 1, 9.0f);
  prediction.at(2, 0) = 2;
  const auto errors = depth_errors(prediction, reference, mask);
  CHECK(errors->absrel == 0);
  CHECK(errors->num_pixels == 1);
  mask.at(2, 0) = 0;
  CHECK_FALSE(depth_errors(prediction, reference, mask));
}

TEST_CASE("alignment undoes a scale, and affine alignment a shift too") {
  const Image reference = golden::make_image(9, 5, 1, [](int x, int y, int) {
    return 1.0f + 0.25f * static_cast<float>(x) + 0.5f * static_cast<float>(y);
  });
  const Image doubled =
      golden::make_image(9, 5, 1, [&](int x, int y, int) { return 2 * reference.at(x, y); });
  const Image shifted =
      golden::make_image(9, 5, 1, [&](int x, int y, int) { return 2 * reference.at(x, y) + 1; });
  for (const auto mode : {DepthAlignment::kMedian, DepthAlignment::kScale, DepthAlignment::kAffine})
    CHECK(depth_errors(doubled, reference, {}, aligned(mode))->absrel == Approx(0).margin(1e-14));
  const auto affine = depth_errors(shifted, reference, {}, aligned(DepthAlignment::kAffine));
  CHECK(affine->absrel == Approx(0).margin(1e-14));
  CHECK(affine->fit.scale == Approx(0.5).epsilon(1e-12));
  CHECK(affine->fit.shift == Approx(-0.5).epsilon(1e-12));
  CHECK(depth_errors(shifted, reference, {}, aligned(DepthAlignment::kScale))->absrel > 0.01);
}

TEST_CASE("an affine fit of a constant prediction is the mean of the reference") {
  const Image reference =
      golden::make_image(5, 1, 1, [](int x, int, int) { return 1.0f + static_cast<float>(x); });
  const DepthFit fit =
      fit_depth(Image(5, 1, 1, 7.0f), reference, {}, aligned(DepthAlignment::kAffine));
  CHECK(fit.scale == 0);
  CHECK(fit.shift == 3);
}

TEST_CASE("the release's protocol skips holes and depths from 20 m on") {
  Image reference(4, 1, 1, 2.0f), prediction(4, 1, 1, 4.0f);
  prediction.at(0, 0) = 0;
  reference.at(1, 0) = 20;
  prediction.at(2, 0) = 21;
  const auto errors = depth_errors(prediction, reference, {}, release_depth_protocol());
  CHECK(errors->num_pixels == 1);
  CHECK(errors->absrel == 0);
  CHECK(errors->fit.scale == 0.5);
}

TEST_CASE("depth maps of another size or with three channels are refused") {
  const Image depth(4, 3, 1, 1.0f);
  CHECK_THROWS_WITH(depth_errors(Image(3, 3, 1, 1.0f), depth), Catch::Contains("3 x 3"));
  CHECK_THROWS_WITH(
      depth_errors(Image(4, 3, 3), Image(4, 3, 3)), Catch::Contains("3 channels, expected 1")
  );
}
