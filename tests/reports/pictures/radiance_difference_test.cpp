// SPDX-License-Identifier: MIT
#include "reports/pictures/radiance_difference.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "glint/core/config.h"
#include "glint/drawing/picture_grid.h"
#include "glint/scene/image_files.h"
#include "tests/reports/run_words.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

// 16x8 pixels of radiance 1 beside such of `right`; the right half is glass.
Image halves(float right) {
  Image image(16, 8, 3, 1.0f);
  for (int y = 0; y < 8; ++y)
    for (int x = 8; x < 16; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = right;
  return image;
}

std::vector<bool> right_half() {
  std::vector<bool> glass(16 * 8);
  for (std::size_t i = 0; i < glass.size(); ++i) glass[i] = i % 16 >= 8;
  return glass;
}

void write_rendering(const fs::path& folder, const std::string& view, const Image& radiance) {
  write_exr(folder / "gt" / "rgb" / (view + ".exr"), radiance);
}

}  // namespace

TEST_CASE("Ratios of radiance are those of the means, apart for glass") {
  const RadianceDifference d = radiance_difference(halves(3), halves(3.3f), right_half());
  CHECK(*d.opaque.ratio() == Approx(1));
  CHECK(*d.glass.ratio() == Approx(1.1));
  CHECK(*d.all().ratio() == Approx(4.3 / 4));
  CHECK(d.glass.pixels == 64);
  CHECK(d.blocks == 2);
  CHECK(*d.block_rms() == Approx(0.1 / std::sqrt(2.0)));
}

TEST_CASE("A region without pixels or light has no ratio") {
  const RadianceDifference d = radiance_difference(Image(4, 4, 3), Image(4, 4, 3, 1.0f), {});
  CHECK_FALSE(d.opaque.ratio());
  CHECK_FALSE(d.glass.ratio());
  CHECK_FALSE(d.block_rms());
}

TEST_CASE("Relative differences are those of means over 5x5 pixels") {
  const Image brighter = relative_difference(halves(1), halves(2));
  CHECK(brighter.at(0, 4) == 0);
  CHECK(brighter.at(15, 4) == Approx(1));
  CHECK(brighter.at(8, 4) == Approx(3.0 / 5));  // three of five columns are twice as bright
  CHECK(relative_difference(halves(1), halves(0.5f)).at(15, 4) == Approx(-0.5));
  CHECK(relative_difference(halves(0), halves(0)).at(15, 4) == 0);
  CHECK(relative_difference(halves(0), halves(1)).at(15, 4) > 100);
}

TEST_CASE("dataset compare takes the views that both folders have") {
  const TempFolder folder;
  const std::string a = folder / "a", b = folder / "b", png = folder / "difference.png";
  for (const char* view : {"0000", "0001"}) write_rendering(a, view, halves(2));
  write_rendering(b, "0001", halves(3));
  write_png(fs::path(a) / "gt" / "glass" / "0001.png", Image(16, 8, 1, 1.0f));
  const std::vector<std::string> words{"dataset", "compare", a, b, "--picture", png};
  CHECK_THAT(captured(1, [&] { CHECK(run(words) == 0); }), Contains("0001       1.3333        -"));
  const ImageSize size = read_image_size(png);
  CHECK(size.width > 3 * kMinPanelWidth);  // three panels, and words around one row of them
  CHECK(size.height > 100);
  CHECK(size.height < 400);
  const Json json = Json::parse(captured(1, [&] {
    CHECK(run({"dataset", "compare", a, b, "--json"}) == 0);
  }));
  CHECK(json["views"].size() == 1);
  CHECK(json["together"]["ratio_glass"] == Approx(4.0 / 3));
  CHECK(json["together"]["ratio_opaque"].is_null());
}

TEST_CASE("Renderings without a common view, or of other sizes, are refused") {
  const TempFolder folder;
  const fs::path a = folder / "a", b = folder / "b";
  write_rendering(a, "0000", halves(2));
  write_rendering(b, "0001", halves(2));
  CHECK_THAT(
      bad_reference([&] { compare_renderings(a, b, {}, 0.1f); }), Contains("two renderings")
  );
  write_rendering(b, "0000", Image(8, 8, 3));
  CHECK_THAT(bad_reference([&] { compare_renderings(a, b, {}, 0.1f); }), Contains("8 x 8"));
  CHECK(run({"dataset", "compare", a, folder / "nowhere"}) == 3);
}
