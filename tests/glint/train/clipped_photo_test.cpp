// SPDX-License-Identifier: MIT
#include "glint/train/clipped_photo.h"

#include <catch2/catch.hpp>

#include "glint/core/error.h"

using namespace glint;

TEST_CASE("Where a photo is white, being brighter is no error and has no gradient") {
  Image rendered(2, 1, 3), photo(2, 1, 3, 0.5f), gradient(2, 1, 3, 1.0f);
  rendered.array() = {1.5f, 0.9f, 1.5f, 1.5f, 0.2f, 0.7f};
  photo.data()[0] = photo.data()[1] = 1;
  photo.data()[3] = ClippedPhoto::kWhite;
  ClippedPhoto clip;
  const Image& clipped = clip.clip(rendered, photo);
  const float expected[] = {1, 0.9f, 1.5f, ClippedPhoto::kWhite, 0.2f, 0.7f};
  ClippedPhoto::clip_vjp(rendered, photo, gradient);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(clipped.data()[i] == expected[i]);
    CHECK(gradient.data()[i] == (i == 0 || i == 3 ? 0.0f : 1.0f));
  }
  CHECK_THROWS_AS(clip.clip(rendered, Image(3, 1, 3)), Error);
}
