// SPDX-License-Identifier: MIT
// Image pairs with values by independent code (../shared/data, not part of the project).
#include <catch2/catch.hpp>

#include "glint/core/config.h"
#include "glint/core/files.h"
#include "glint/scene/image_files.h"
#include "metrics/psnr.h"
#include "metrics/ssim.h"

using namespace glint;

TEST_CASE("PSNR and SSIM of real image pairs agree with independent code") {
  const fs::path folder = "../shared/data/metric_pairs";
  if (!fs::exists(folder / "image_metrics.json")) {
    WARN("skipped: " << folder << " is absent");
    return;
  }
  for (const Json& pair : Json::parse(read_file(folder / "image_metrics.json"))) {
    const std::string test = pair["test"], ref = pair["ref"];
    const Image prediction = read_image(folder / "images" / test, 3);
    const Image reference = read_image(folder / "images" / ref, 3);
    CAPTURE(test, ref);
    // Their images are in double, ours in single precision.
    const auto expected = [&](const char* key) {
      return Approx(pair[key].get<double>()).margin(1e-7);
    };
    CHECK(mse(prediction, reference) == expected("mse"));
    CHECK(psnr(prediction, reference) == expected("psnr").margin(1e-5));
    CHECK(ssim_3dgs(prediction, reference) == expected("ssim_zero_padded"));
    CHECK(ssim_wang(prediction, reference) == expected("ssim_skimage_gauss"));
  }
}
