// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "glint/core/error.h"
#include "glint/render/raster_tiles.h"

using namespace glint;
using Catch::Matchers::Contains;

TEST_CASE("Pairs of surfels and tiles are numbered surfel by surfel") {
  const std::vector<PixelBox> boxes{{0, 8, 0, 8}, {}, {4, 12, 0, 17}, {3, 4, 3, 4}};
  std::vector<std::uint32_t> first;
  number_pairs(boxes, {32, 32}, first);
  CHECK(first == std::vector<std::uint32_t>{0, 1, 1, 7, 8});
}

TEST_CASE("More pairs of surfels and tiles than 32 bits count are an error that says what to do") {
  // 2^9 x 2^9 tiles, reached by all of 2^14 surfels: one pair more than 2^32 - 1.
  const std::vector<PixelBox> boxes(std::size_t{1} << 14, PixelBox{0, 4096, 0, 4096});
  std::vector<std::uint32_t> first;
  CHECK_THROWS_WITH(
      number_pairs(boxes, {4096, 4096}, first),
      Contains("16384 surfels") && Contains("4096x4096") && Contains("fewer surfels")
  );
  number_pairs({boxes.begin(), boxes.end() - 1}, {4096, 4096}, first);
  CHECK(first.back() == ((std::uint64_t{1} << 32) - (std::uint64_t{1} << 18)));
}
