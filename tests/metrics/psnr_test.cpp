// SPDX-License-Identifier: MIT
#include "metrics/psnr.h"

#include <catch2/catch.hpp>

#include <limits>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "tests/metrics/golden_images.h"

using namespace glint;

namespace {

ExitCode exit_code_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.code();
  }
  return ExitCode::kSuccess;
}

}  // namespace

TEST_CASE("a constant offset of d has a PSNR of -20 log10(d)") {
  for (const float d : {0.5f, 0.25f, 0.125f}) {
    const Image reference(7, 5, 3, 0.25f), prediction(7, 5, 3, 0.25f + d);
    CHECK(
        psnr(prediction, reference) ==
        Approx(-20 * std::log10(static_cast<double>(d))).epsilon(1e-14)
    );
    CHECK(psnr(reference, prediction) == psnr(prediction, reference));
  }
}

TEST_CASE("a checkerboard shifted by one pixel differs everywhere by one: 0 dB") {
  const auto board = [](int shift) {
    return golden::make_image(8, 6, 1, [shift](int x, int y, int) {
      return (x + y + shift) % 2 == 0 ? 1.0f : 0.0f;
    });
  };
  CHECK(mse(board(0), board(1)) == 1);
  CHECK(psnr(board(0), board(1)) == 0);
}

TEST_CASE("identical images get the cap of 100 dB, as do almost identical ones") {
  const Image image = golden::reference_image(16, 9, 3);
  CHECK(psnr(image, image) == 100);
  Image other = image;
  other.at(3, 3, 1) += 1e-6f;
  CHECK(psnr(other, image) == 100);
}

TEST_CASE("all channels share one mean squared error") {
  Image prediction(4, 4, 3, 0.0f);
  const Image reference(4, 4, 3, 0.0f);
  for (int i = 0; i < 16; ++i) prediction.data()[3 * i] = 0.5f;  // red only
  CHECK(mse(prediction, reference) == Approx(0.25 / 3).epsilon(1e-15));
}

TEST_CASE("predictions are clamped to [0, 1], references are not") {
  const Image bright(3, 3, 3, 1.5f), white(3, 3, 3, 1.0f), dark(3, 3, 3, -0.5f),
      black(3, 3, 3, 0.0f);
  CHECK(psnr(bright, white) == 100);
  CHECK(psnr(dark, black) == 100);
  CHECK(mse(white, bright) == 0.25);
  CHECK(mse(bright, white, {}, {.clamp = false}) == 0.25);
}

TEST_CASE("psnr-8bit rounds half to even before it compares") {
  // 0.5 and 2.5 steps of 1/255 round to 0 and 2.
  Image prediction(2, 1, 1);
  prediction.at(0, 0) = 0.5f / 255.0f;
  prediction.at(1, 0) = 2.5f / 255.0f;
  Image reference(2, 1, 1);
  reference.at(1, 0) = 2.0f / 255.0f;
  CHECK(psnr_8bit(prediction, reference) == 100);
  CHECK(psnr(prediction, reference) < 60);
}

TEST_CASE("a masked PSNR is the mean over the masked pixels, not over all") {
  Image prediction(10, 10, 3, 0.0f);
  const Image reference(10, 10, 3, 0.0f);
  MaskImage mask(10, 10, 1);
  for (int x = 0; x < 10; ++x) {
    mask.at(x, 4) = 255;
    for (int c = 0; c < 3; ++c) prediction.at(x, 4, c) = 0.5f;
  }
  CHECK(mse(prediction, reference, mask) == 0.25);
  CHECK(mse(prediction, reference) == Approx(0.025).epsilon(1e-15));
}

TEST_CASE("PSNR does not depend on the number of threads") {
  const Image reference = golden::reference_image(97, 61, 3);
  const Image prediction = golden::prediction_image(97, 61, 3);
  set_num_threads(1);
  const double one = psnr(prediction, reference);
  set_num_threads(3);
  const double three = psnr(prediction, reference);
  set_num_threads(0);
  CHECK(one == three);
}

TEST_CASE("images that cannot be compared are refused with the side at fault") {
  const Image a(4, 3, 3, 0.5f), wide(5, 3, 3, 0.5f), grey(4, 3, 1, 0.5f);
  Image broken = a;
  broken.at(2, 1, 0) = std::numeric_limits<float>::quiet_NaN();
  CHECK(exit_code_of([&] { psnr(wide, a); }) == ExitCode::kBadPrediction);
  CHECK(exit_code_of([&] { psnr(grey, a); }) == ExitCode::kBadPrediction);
  CHECK(exit_code_of([&] { psnr(broken, a); }) == ExitCode::kBadPrediction);
  CHECK(exit_code_of([&] { psnr(a, broken); }) == ExitCode::kBadReference);
  CHECK(exit_code_of([&] { psnr(a, a, MaskImage(4, 3, 1)); }) == ExitCode::kBadReference);
  CHECK(exit_code_of([&] { psnr(a, a, MaskImage(3, 4, 1)); }) == ExitCode::kBadReference);
  CHECK_THROWS_WITH(psnr(broken, a), Catch::Contains("(2, 1)"));
}
