// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "glint/core/image.h"

namespace glint::test {

// Over all values of two images of one shape.
inline float largest_difference(ImageView a, ImageView b) {
  REQUIRE(a.size() == b.size());
  REQUIRE(a.channels == b.channels);
  float largest = 0;
  for (std::size_t i = 0; i < a.num_pixels() * static_cast<std::size_t>(a.channels); ++i)
    largest = std::max(largest, std::abs(a.data[i] - b.data[i]));
  return largest;
}

}  // namespace glint::test
