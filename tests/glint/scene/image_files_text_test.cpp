// SPDX-License-Identifier: MIT
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "glint/scene/image_files.h"

using namespace glint;

TEST_CASE("letters are black, as tall as asked for, and end where their width says") {
  Image picture(200, 60, 3, 1.0f);
  draw_text(picture, "HI", 20, 40, 20);
  int left = 200, right = 0, top = 60, bottom = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 200; ++x)
      if (picture.at(x, y, 1) < 0.5f) {
        left = std::min(left, x), right = std::max(right, x);
        top = std::min(top, y), bottom = std::max(bottom, y);
      }
  CHECK(left >= 20);
  CHECK(right < 20 + text_width("HI", 20));
  CHECK(std::abs(bottom - 40) <= 1);
  CHECK(std::abs(bottom - top + 1 - 20) <= 2);
  CHECK(text_width("HIHI", 20) > text_width("HI", 20));
}

TEST_CASE("letters outside of the picture are cut off") {
  Image picture(10, 6, 3, 1.0f);
  draw_text(picture, "far too long and too tall", -5, 20, 30);
  CHECK(picture.size() == ImageSize{10, 6});
  const Image white(10, 6, 3, 1.0f);
  Image untouched = white;
  draw_text(untouched, "elsewhere", 50, 50, 8);
  CHECK(std::equal(untouched.values().begin(), untouched.values().end(), white.data()));
}
