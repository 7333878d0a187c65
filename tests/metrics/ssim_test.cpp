// SPDX-License-Identifier: MIT
#include "metrics/ssim.h"

#include <catch2/catch.hpp>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/core/simd.h"
#include "tests/metrics/golden_images.h"

using namespace glint;

TEST_CASE("the SSIM window is symmetric and sums to one") {
  const auto window = ssim_window<double>();
  double sum = 0;
  for (int i = 0; i < kSsimTaps; ++i) {
    CHECK(window[i] == window[kSsimTaps - 1 - i]);
    sum += window[i];
  }
  CHECK(sum == Approx(1).epsilon(1e-15));
  CHECK(window[kSsimRadius] / window[kSsimRadius + 3] == Approx(std::exp(2.0)).epsilon(1e-14));
}

TEST_CASE("constant images have the luminance term alone, and 1 where windows leave the image") {
  const Image x(21, 17, 3, 0.25f), y(21, 17, 3, 0.75f);
  const double expected = (2 * 0.25 * 0.75 + kSsimC1) / (0.0625 + 0.5625 + kSsimC1);
  CHECK(ssim_wang(x, y) == Approx(expected).epsilon(1e-12));
  const Image black(21, 17, 3, 0.0f);
  CHECK(ssim_3dgs(black, black) == 1);
}

TEST_CASE("an inverted image has negative similarity, an identical one has one") {
  const Image x = golden::reference_image(40, 30, 3);
  const Image inverted =
      golden::make_image(40, 30, 3, [&](int i, int j, int c) { return 1 - x.at(i, j, c); });
  CHECK(ssim_wang(x, x) == Approx(1).epsilon(1e-14));
  CHECK(ssim_3dgs(x, x) == Approx(1).epsilon(1e-14));
  CHECK(ssim_wang(inverted, x) < 0);
}

TEST_CASE("SSIM is symmetric") {
  const Image x = golden::reference_image(37, 29, 3), y = golden::prediction_image(37, 29, 3);
  CHECK(ssim_3dgs(x, y) == Approx(ssim_3dgs(y, x)).epsilon(1e-13));
}

TEST_CASE("both variants agree away from the border") {
  const Image x = golden::prediction_image(33, 33, 3), y = golden::reference_image(33, 33, 3);
  MaskImage inner(33, 33, 1);
  for (int j = 5; j < 28; ++j)
    for (int i = 5; i < 28; ++i) inner.at(i, j) = 1;
  CHECK(ssim_3dgs(x, y, inner) == Approx(ssim_wang(x, y)).epsilon(1e-14));
}

TEST_CASE("an image smaller than the window has no valid region") {
  const Image small(10, 30, 3, 0.5f);
  CHECK(ssim_3dgs(small, small) == Approx(1).epsilon(1e-14));
  CHECK_THROWS_WITH(ssim_wang(small, small), Catch::Contains("10 x 30"));
}

TEST_CASE("SSIM does not depend on the number of threads") {
  const Image x = golden::prediction_image(150, 101, 3), y = golden::reference_image(150, 101, 3);
  set_num_threads(1);
  const double one = ssim_3dgs(x, y);
  set_num_threads(3);
  const double three = ssim_3dgs(x, y);
  set_num_threads(0);
  CHECK(one == three);
}

TEST_CASE("ssim_from_moments is the same text for Float8 and float") {
  const float lanes = ssim_from_moments<Float8>(0.5f, 0.4f, 0.3f, 0.2f, 0.21f)[3];
  CHECK(lanes == ssim_from_moments(0.5f, 0.4f, 0.3f, 0.2f, 0.21f));
}

TEST_CASE("ssim_from_moments_vjp matches central differences") {
  const double y = 0.4, yy = 0.2, weight = 1.7, h = 1e-6;
  for (const auto& [x, xx, xy] :
       {std::array{0.5, 0.3, 0.21}, {0.1, 0.02, 0.05}, {0.9, 0.82, 0.35}}) {
    double dL_dmu_x = 1, dL_dxx = 2, dL_dxy = 3;  // accumulated onto
    ssim_from_moments_vjp(x, y, xx, yy, xy, weight, dL_dmu_x, dL_dxx, dL_dxy);
    const auto f = [&, x = x, xx = xx, xy = xy](double a, double b, double c) {
      return weight * ssim_from_moments(x + a, y, xx + b, yy, xy + c);
    };
    CHECK(dL_dmu_x - 1 == Approx((f(h, 0, 0) - f(-h, 0, 0)) / (2 * h)).epsilon(1e-6));
    CHECK(dL_dxx - 2 == Approx((f(0, h, 0) - f(0, -h, 0)) / (2 * h)).epsilon(1e-6));
    CHECK(dL_dxy - 3 == Approx((f(0, 0, h) - f(0, 0, -h)) / (2 * h)).epsilon(1e-6));
  }
}
