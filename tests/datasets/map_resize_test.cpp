// SPDX-License-Identifier: MIT
#include "datasets/map_resize.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "glint/core/vec.h"

using namespace glint;

TEST_CASE("a plane's depth stays exact at any new size") {
  // Inverse depth of a plane is affine in the image point.
  const auto inverse = [](double x, double y, ImageSize size) {
    return 0.3 + 0.2 * x / size.width + 0.1 * y / size.height;
  };
  const ImageSize old_size{36, 24};
  Image depth(old_size.width, old_size.height, 1);
  for (int y = 0; y < old_size.height; ++y)
    for (int x = 0; x < old_size.width; ++x)
      depth.at(x, y) = static_cast<float>(1 / inverse(x + 0.5, y + 0.5, old_size));
  for (const ImageSize size : {ImageSize{18, 12}, ImageSize{12, 6}, ImageSize{36, 24}}) {
    const Image result = resize_depth(depth, size);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        CHECK(
            static_cast<double>(result.at(x, y)) ==
            Approx(1 / inverse(x + 0.5, y + 0.5, size)).epsilon(1e-6)
        );
  }
}

TEST_CASE("depth is never blended across an edge or with missing pixels") {
  Image depth(6, 2, 1);
  const float row[] = {1, 1, 1, 9, 0, 0};
  for (int y = 0; y < 2; ++y) std::copy(std::begin(row), std::end(row), depth.pixel(0, y));
  const Image result = resize_depth(depth, {2, 1});
  CHECK(result.at(0, 0) == 1);
  CHECK(result.at(1, 0) == 0);  // two thirds are missing
  const Image thirds = resize_depth(depth, {3, 1});
  CHECK(thirds.at(0, 0) == 1);
  CHECK((thirds.at(1, 0) == 1 || thirds.at(1, 0) == 9));
  CHECK(thirds.at(2, 0) == 0);
}

TEST_CASE("depth grows by repeating") {
  Image depth(2, 1, 1);
  depth.at(0, 0) = 1;
  depth.at(1, 0) = 3;
  const Image result = resize_depth(depth, {4, 2});
  CHECK(result.at(1, 1) == 1);
  CHECK(result.at(2, 0) == 3);
}

TEST_CASE("normals stay unit and missing ones missing") {
  Image normal(4, 2, 3);
  for (int y = 0; y < 2; ++y) {
    normal.at(0, y, 2) = -1;
    normal.at(1, y, 0) = 1;
  }
  const Image result = resize_normal(normal, {2, 1});
  CHECK(result.at(0, 0, 0) == Approx(std::sqrt(0.5)));
  CHECK(result.at(0, 0, 2) == Approx(-std::sqrt(0.5)));
  CHECK(result.at(1, 0, 0) == 0);
  CHECK(result.at(1, 0, 2) == 0);
}

TEST_CASE("a mask pixel counts when half of its area does") {
  MaskImage mask(4, 1, 1);
  mask.at(0, 0) = 255;
  const MaskImage result = resize_mask(mask, {2, 1});
  CHECK(result.at(0, 0) == 255);
  CHECK(result.at(1, 0) == 0);
  CHECK(resize_mask(mask, {1, 1}).at(0, 0) == 0);
}
