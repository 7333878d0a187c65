// SPDX-License-Identifier: MIT
#include "metrics/transparency.h"

#include <catch2/catch.hpp>

#include "glint/core/error.h"
#include "tests/metrics/golden_images.h"

using namespace glint;

namespace {

MaskImage left_half(int width, int height) {
  MaskImage mask(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width / 2; ++x) mask.at(x, y) = 255;
  return mask;
}

}  // namespace

TEST_CASE("a map that equals the glass mask scores 1 and 0") {
  const MaskImage glass = left_half(8, 4);
  const Image map =
      golden::make_image(8, 4, 1, [&](int x, int y, int) { return glass.at(x, y) ? 1.0f : 0.0f; });
  CHECK(*transparency_iou(map, glass) == 1);
  CHECK(*transparency_mae(map, glass) == 0);
}

TEST_CASE("IoU of a map shifted by a quarter of the image is one third") {
  const Image map = golden::make_image(8, 4, 1, [](int x, int, int) {
    return x >= 2 && x < 6 ? 0.5f : 0.49f;  // the threshold itself is glass
  });
  CHECK(*transparency_iou(map, left_half(8, 4)) == Approx(1.0 / 3).epsilon(1e-15));
}

TEST_CASE("a constant map has the mean absolute error of its distance to both classes") {
  CHECK(*transparency_mae(Image(8, 4, 1, 0.25f), left_half(8, 4)) == 0.5);
  CHECK(*transparency_mae(Image(8, 4, 1, 0.25f), MaskImage(8, 4, 1)) == 0.25);
  CHECK(*transparency_mae(Image(8, 4, 1, 1.5f), MaskImage(8, 4, 1, 1)) == 0);  // clamped
}

TEST_CASE("a view without true glass has no IoU, whatever is called glass there") {
  CHECK_FALSE(transparency_iou(Image(4, 4, 1, 0.1f), MaskImage(4, 4, 1)));
  CHECK_FALSE(transparency_iou(Image(4, 4, 1, 0.9f), MaskImage(4, 4, 1)));
}

TEST_CASE("masks choose the pixels of transparency scores") {
  const Image map(8, 4, 1, 1.0f);
  const MaskImage glass = left_half(8, 4);
  CHECK(*transparency_iou(map, glass, glass) == 1);
  CHECK(*transparency_iou(map, glass) == 0.5);
  CHECK_FALSE(transparency_mae(map, glass, MaskImage(8, 4, 1)));
}

TEST_CASE("transparency maps of another size or with NaN are refused") {
  CHECK_THROWS_WITH(transparency_mae(Image(3, 4, 1), MaskImage(8, 4, 1)), Catch::Contains("3 x 4"));
  const Image broken(8, 4, 1, std::numeric_limits<float>::quiet_NaN());
  CHECK_THROWS_WITH(transparency_mae(broken, MaskImage(8, 4, 1)), Catch::Contains("nan"));
}
