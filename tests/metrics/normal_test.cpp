// SPDX-License-Identifier: MIT
#include "metrics/normal.h"

#include <catch2/catch.hpp>

#include <numbers>

#include "glint/core/error.h"
#include "tests/metrics/golden_images.h"

using namespace glint;

namespace {

// Normals in the x-z plane, turned by an angle per pixel from the direction to the camera.
template <class F>
Image turned(int width, int height, F&& angle_deg) {
  return golden::make_image(width, height, 3, [&](int x, int y, int c) {
    const double a = angle_deg(x, y) * std::numbers::pi / 180;
    const double n[3] = {std::sin(a), 0, -std::cos(a)};
    return static_cast<float>(n[c]);
  });
}
Image turned(int width, int height, double angle_deg) {
  return turned(width, height, [=](int, int) { return angle_deg; });
}

}  // namespace

TEST_CASE("a rotation by a known angle is measured from tiny to opposite") {
  const Image reference = turned(3, 2, 0.0);
  for (const double angle : {0.0, 1e-3, 10.0, 90.0, 179.999, 180.0})
    CHECK(normal_errors(turned(3, 2, angle), reference)->mean_deg == Approx(angle).margin(1e-5));
}

TEST_CASE("the length of a predicted normal does not matter, a zero one counts as 90 degrees") {
  const Image reference = turned(4, 1, 0.0);
  Image prediction = golden::make_image(4, 1, 3, [&](int x, int y, int c) {
    return 0.3f * reference.at(x, y, c);
  });
  CHECK(normal_errors(prediction, reference)->mean_deg == 0);
  for (int c = 0; c < 3; ++c) prediction.at(0, 0, c) = 0;
  prediction.at(1, 0, 2) = std::numeric_limits<float>::quiet_NaN();
  const auto errors = normal_errors(prediction, reference);
  CHECK(errors->mean_deg == 45);
  CHECK(errors->median_deg == 45);  // the mean of the two middle values of 0 0 90 90
  CHECK(errors->coverage == 50);
}

TEST_CASE("shares are strictly below their thresholds") {
  const Image reference = turned(1, 1, 0.0);
  const auto right_angle = [&](NormalProtocol protocol) {
    return normal_errors(Image(1, 1, 3), reference, {}, protocol)->below;
  };
  NormalProtocol protocol;
  protocol.missing_deg = 11.25;  // exactly on a threshold
  CHECK(right_angle(protocol) == std::array<double, 5>{0, 0, 0, 100, 100});
}

TEST_CASE("reference normals that are not of unit length are dropped and counted") {
  Image reference = turned(4, 1, 0.0);
  for (int c = 0; c < 3; ++c) reference.at(0, 0, c) *= 0.5f;  // blended at an edge
  for (int c = 0; c < 3; ++c) reference.at(1, 0, c) = 0;      // no surface
  const auto errors = normal_errors(turned(4, 1, 20.0), reference);
  CHECK(errors->num_pixels == 2);
  CHECK(errors->dropped == Approx(100.0 / 3).epsilon(1e-14));
  CHECK(errors->mean_deg == Approx(20).epsilon(1e-6));
}

TEST_CASE("with background, empty pixels are right where nothing is predicted and wrong elsewhere"
) {
  Image reference = turned(4, 1, 0.0), prediction = turned(4, 1, 20.0);
  for (int x = 0; x < 3; ++x)
    for (int c = 0; c < 3; ++c) reference.at(x, 0, c) = 0;  // three pixels of background
  for (int x = 0; x < 2; ++x)
    for (int c = 0; c < 3; ++c) prediction.at(x, 0, c) = 0;  // two of them left empty
  const auto errors = normal_errors(prediction, reference);
  CHECK(errors->mean_deg == Approx(20).epsilon(1e-6));
  CHECK(errors->mean_with_background_deg == Approx((20 + 0 + 0 + 90) / 4.0).epsilon(1e-6));
  const Image whole = turned(4, 1, 0.0);
  const auto covered = normal_errors(turned(4, 1, 20.0), whole);
  CHECK(covered->mean_with_background_deg == covered->mean_deg);
}

TEST_CASE("masks choose the pixels of normal errors") {
  const Image reference = turned(2, 1, 0.0);
  const Image prediction = turned(2, 1, [](int x, int) { return x == 0 ? 10.0 : 50.0; });
  MaskImage mask(2, 1, 1);
  CHECK_FALSE(normal_errors(prediction, reference, mask));
  mask.at(1, 0) = 255;
  CHECK(normal_errors(prediction, reference, mask)->mean_deg == Approx(50).epsilon(1e-6));
}

TEST_CASE("the angle does not depend on which map is the reference") {
  const Image a = turned(5, 5, [](int x, int y) { return 7.0 * x + 3.0 * y; });
  const Image b = turned(5, 5, [](int x, int y) { return 2.0 * x - 5.0 * y; });
  CHECK(normal_errors(a, b)->mean_deg == Approx(normal_errors(b, a)->mean_deg).epsilon(1e-14));
}

TEST_CASE("normal maps need three channels") {
  CHECK_THROWS_WITH(
      normal_errors(Image(2, 2, 1), Image(2, 2, 1)), Catch::Contains("1 channels, expected 3")
  );
}
