// SPDX-License-Identifier: MIT
#include "glint/drawing/color_maps.h"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <limits>

#include "glint/scene/image_files.h"

using namespace glint;

namespace {

std::array<double, 3> entry(const ColorTable& table, std::size_t i) {
  return {table[3 * i] / 1e6, table[3 * i + 1] / 1e6, table[3 * i + 2] / 1e6};
}

// CIE 1976 L* under D65.
double lightness(const std::array<double, 3>& color) {
  const auto linear = [&](std::size_t c) {
    return static_cast<double>(srgb_decode(static_cast<float>(color[c])));
  };
  const double y = 0.2126 * linear(0) + 0.7152 * linear(1) + 0.0722 * linear(2);
  return y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : y * 24389 / 27;
}

}  // namespace

TEST_CASE("the tables are the published ones") {
  CHECK(entry(kViridis, 0) == std::array<double, 3>{0.267004, 0.004874, 0.329415});
  CHECK(entry(kViridis, 128) == std::array<double, 3>{0.127568, 0.566949, 0.550556});
  CHECK(entry(kViridis, 255) == std::array<double, 3>{0.993248, 0.906157, 0.143936});
  CHECK(entry(kMagma, 0) == std::array<double, 3>{0.001462, 0.000466, 0.013866});
  CHECK(entry(kMagma, 128) == std::array<double, 3>{0.716387, 0.214982, 0.47529});
  CHECK(entry(kMagma, 255) == std::array<double, 3>{0.987053, 0.991438, 0.749504});
}

TEST_CASE("every entry of a table is lighter than the one before, in nearly even steps") {
  for (const ColorTable* table : {&kViridis, &kMagma}) {
    const double range = lightness(entry(*table, 255)) - lightness(entry(*table, 0));
    CHECK(range > 70);
    for (std::size_t i = 1; i < 256; ++i) {
      const double step = lightness(entry(*table, i)) - lightness(entry(*table, i - 1));
      INFO(i);
      CHECK(step > 0);
      CHECK(step < 2 * range / 255);
    }
  }
}

TEST_CASE("a value between two entries has a colour between theirs") {
  Image ramp(3, 1, 1);
  for (int i = 0; i < 3; ++i) ramp.at(i, 0) = static_cast<float>(2 * i) / 4 + 100;  // 0, 1/2, 1
  const Image colors = colorize_scalar(ramp, 100, 101, ScalarColors::kViridis);
  for (int c = 0; c < 3; ++c) {
    const auto at = static_cast<std::size_t>(c);
    const double middle = (entry(kViridis, 127)[at] + entry(kViridis, 128)[at]) / 2;
    CHECK(static_cast<double>(colors.at(0, 0, c)) == Approx(entry(kViridis, 0)[at]));
    CHECK(static_cast<double>(colors.at(1, 0, c)) == Approx(middle));
    CHECK(static_cast<double>(colors.at(2, 0, c)) == Approx(entry(kViridis, 255)[at]));
  }
}

TEST_CASE("colour maps leave missing pixels black and turn normals towards the viewer") {
  Image depth(3, 1, 1);
  depth.at(0, 0) = 1;
  depth.at(1, 0) = 5;
  const Image colors = colorize_depth(depth, 1, 5);
  CHECK(colors.at(0, 0, 0) > 0.9f);  // near: yellow
  CHECK(colors.at(1, 0, 1) < 0.1f);  // far: violet
  CHECK(colors.at(2, 0, 0) + colors.at(2, 0, 1) + colors.at(2, 0, 2) == 0);
  Image normal(2, 1, 3);
  normal.at(0, 0, 2) = -1;  // facing the camera
  const Image shown = colorize_normal(normal);
  CHECK(shown.at(0, 0, 2) == 1);
  CHECK(shown.at(0, 0, 0) == 0.5f);
  CHECK(shown.at(1, 0, 0) == 0);
}

TEST_CASE("shares are grey from black to white, by their first channel") {
  Image map(3, 1, 2, 0.7f);
  map.at(0, 0, 0) = -1, map.at(1, 0, 0) = 0.25f, map.at(2, 0, 0) = 2;
  const Image picture = grey_picture(map);
  REQUIRE(picture.channels() == 3);
  for (int c = 0; c < 3; ++c) {
    CHECK(picture.at(0, 0, c) == 0);
    CHECK(picture.at(1, 0, c) == 0.25f);
    CHECK(picture.at(2, 0, c) == 1);
  }
}

TEST_CASE("colours of scalar maps get lighter with the value, and grey where there is none") {
  Image ramp(11, 1, 1);
  for (int i = 0; i < 10; ++i) ramp.at(i, 0) = 2.0f + static_cast<float>(i) / 9;
  ramp.at(10, 0) = std::numeric_limits<float>::quiet_NaN();
  for (const ScalarColors map : {ScalarColors::kViridis, ScalarColors::kMagma}) {
    const Image colors = colorize_scalar(ramp, 2, 3, map);
    const auto luminance = [&](int x) {  // Rec. 709 of linear values
      return 0.2126f * srgb_decode(colors.at(x, 0, 0)) + 0.7152f * srgb_decode(colors.at(x, 0, 1)) +
             0.0722f * srgb_decode(colors.at(x, 0, 2));
    };
    for (int i = 1; i < 10; ++i) CHECK(luminance(i) > luminance(i - 1));
    CHECK(colors.at(10, 0, 0) == 0.5f);
    CHECK(colorize_scalar(Image(1, 1, 1, 99.0f), 2, 3, map).at(0, 0, 1) == colors.at(9, 0, 1));
  }
}
