// SPDX-License-Identifier: MIT
#include <algorithm>
#include <catch2/catch.hpp>

#include "glint/scene/image_files.h"

using namespace glint;

TEST_CASE("shrinking averages areas, growing keeps constants") {
  Image image(4, 2, 1);
  for (int i = 0; i < 8; ++i) image.data()[i] = static_cast<float>(i);
  const Image half = resize_image(image, {2, 1});
  CHECK(half.at(0, 0) == Approx((0 + 1 + 4 + 5) / 4.0));
  CHECK(half.at(1, 0) == Approx((2 + 3 + 6 + 7) / 4.0));
  const Image grown = resize_image(Image(2, 2, 3, 0.25f), {5, 7});
  for (const float value : grown.values()) CHECK(value == Approx(0.25f));
}
