// SPDX-License-Identifier: MIT
// Where a photo is white, a picture that is brighter is no error.
#include "glint/train/clip_at_white.h"

#include <catch2/catch.hpp>

using namespace glint;

TEST_CASE("A picture is clipped where the photo is white, and has no gradient there") {
  Image photo(2, 1, 3), picture(2, 1, 3), target(2, 1, 3), gradient(2, 1, 3, 1.0f);
  // white and brighter; white and darker; not white and brighter; white, held to less
  const float photos[] = {1, 1, 0.9f, 1, 0, 0}, pictures[] = {1.5f, 0.7f, 1.5f, 0.97f, 0, 0};
  const float targets[] = {1, 1, 0.9f, 0.95f, 0, 0}, expected[] = {1, 0.7f, 1.5f, 0.95f, 0, 0};
  const float gradients[] = {0, 1, 1, 0, 1, 1};
  for (std::size_t i = 0; i < 6; ++i)
    photo.values()[i] = photos[i], picture.values()[i] = pictures[i],
    target.values()[i] = targets[i];
  WhiteClip white;
  const Image& clipped = white.clip(picture, photo, target);
  white.vjp(picture, photo, target, gradient);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(clipped.values()[i] == expected[i]);
    CHECK(gradient.values()[i] == gradients[i]);
  }
}
