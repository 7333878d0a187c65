// SPDX-License-Identifier: MIT
#include "datasets/glassroom/patterns.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace glint;

namespace {

constexpr std::array kSurfacePatterns{
    PatternKind::kPlain,
    PatternKind::kPlanks,
    PatternKind::kParquet,
    PatternKind::kTiles,
    PatternKind::kBricks,
    PatternKind::kWallpaper,
    PatternKind::kCarpet,
    PatternKind::kMarble,
    PatternKind::kWood,
    PatternKind::kFabric,
};

Image pattern(PatternKind kind, std::uint64_t seed = 3) {
  return make_pattern(
      {.kind = kind,
       .colors = {{{0.6f, 0.3f, 0.1f}, {0.2f, 0.3f, 0.5f}, {0.1f, 0.1f, 0.1f}}},
       .seed = seed},
      256
  );
}

double difference(const Image& image, int x0, int y0, int x1, int y1) {
  double sum = 0;
  for (int c = 0; c < 3; ++c)
    sum += std::abs(
        static_cast<double>(image.at(x0, y0, c)) - static_cast<double>(image.at(x1, y1, c))
    );
  return sum / 3;
}

// Mean difference of neighbouring texels across a column or row boundary.
double step_across(const Image& image, int a, int b, bool columns) {
  double sum = 0;
  for (int i = 0; i < image.width(); ++i)
    sum += columns ? difference(image, a, i, b, i) : difference(image, i, a, i, b);
  return sum / image.width();
}

double largest_inner_step(const Image& image, bool columns) {
  double largest = 0;
  for (int i = 0; i + 1 < image.width(); ++i)
    largest = std::max(largest, step_across(image, i, i + 1, columns));
  return largest;
}

}  // namespace

TEST_CASE("Noise is periodic over the unit square and stays in [0, 1]") {
  for (int i = 0; i < 200; ++i) {
    const float u = cell_value(i, 0, 1), v = cell_value(i, 1, 1);
    const float value = fractal_noise(u, v, 5, 4, 9);
    CHECK(value >= 0.0f);
    CHECK(value <= 1.0f);
    CHECK(fractal_noise(u + 1, v, 5, 4, 9) == Approx(value).margin(2e-4));
    CHECK(fractal_noise(u, v + 1, 5, 4, 9) == Approx(value).margin(2e-4));
  }
}

TEST_CASE("Surface patterns repeat without a seam") {
  for (const PatternKind kind : kSurfacePatterns) {
    const Image image = pattern(kind);
    INFO("pattern " << static_cast<int>(kind));
    const int last = image.width() - 1;
    CHECK(step_across(image, last, 0, true) <= 1.05 * largest_inner_step(image, true));
    CHECK(step_across(image, last, 0, false) <= 1.05 * largest_inner_step(image, false));
  }
}

TEST_CASE("Patterns are albedos with texture and depend on the seed") {
  for (const PatternKind kind : kSurfacePatterns) {
    const Image image = pattern(kind), other = pattern(kind, 4);
    INFO("pattern " << static_cast<int>(kind));
    const auto [low, high] = std::minmax_element(image.values().begin(), image.values().end());
    CHECK(*low >= 0.0f);
    CHECK(*high < 1.0f);
    CHECK(*high - *low > 0.1f);
    CHECK_FALSE(std::equal(image.values().begin(), image.values().end(), other.values().begin()));
  }
}

TEST_CASE("sRGB codes become linear colours") {
  const Vec3f color = srgb_hex(0xFF8000);
  CHECK(color.x == Approx(1.0f));
  CHECK(color.y == Approx(0.2158605f));
  CHECK(color.z == 0.0f);
}
