// SPDX-License-Identifier: MIT
#include "reports/show/pictures/strip.h"

#include <catch2/catch.hpp>

#include "glint/drawing/picture_grid.h"
#include "glint/scene/image_files.h"
#include "reports/run/records/run_folder.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using Titles = std::vector<std::string>;

namespace {

constexpr int kWidth = 16, kHeight = 12;

// The test views of the fake scene, as a run folder of a method that gives `output`, too.
std::vector<View> render_views(const fs::path& run, MapSet output) {
  const std::vector<View> views = fake_scene("room_1").test;
  output["rgb"] = Image(kWidth, kHeight, 3, 0.5f);
  output["depth"] = Image(kWidth, kHeight, 1, 2.0f);
  for (const View& view : views) write_render(view_folder(run, view.name), output);
  return views;
}

MapSet decomposed() {
  MapSet output;
  for (const MapRow& row : maps())
    if (!row.shown_file().empty() && row.kind != MapKind::kNormal)
      output[row] = Image(kWidth, kHeight, row.channels(), 0.25f);
  return output;
}

}  // namespace

TEST_CASE("a strip leaves out what the method does not render") {
  const test::TempFolder run;
  const auto views = render_views(run.path(), {});
  CHECK(
      strip_titles(run.path(), views) ==
      Titles{"truth", "rendered", "error x 4", "Depth", "Depth, truth"}
  );
}

TEST_CASE("a strip shows every map of a decomposition, beside its truth where there is any") {
  const test::TempFolder run;
  auto views = render_views(run.path(), decomposed());
  views[1].truth["behind_depth"] = Image(kWidth, kHeight, 1, 4.0f);
  views[0].truth["depth"] = views[1].truth["depth"] = {};
  CHECK(
      strip_titles(run.path(), views) ==
      Titles{
          "truth",
          "rendered",
          "error x 4",
          "Depth",
          "Transparency t",
          "Specularity k_s",
          "Depth behind glass",
          "Depth behind glass, truth",
          "Depth of layer 2",
          "Transparency t of layer 2",
          "Depth of layer 3",
          "Transparency t of layer 3",
          "Depth of layer 4",
          "Transparency t of layer 4",
          "Interface",
          "Transmission",
          "Reflection",
          "Transmitted part",
          "Reflected part",
          "Part T",
          "Part TT",
          "Part R",
          "Part TR",
          "Part RT"}
  );
}

TEST_CASE("strips of a run are written for each view and for the run, alike in width") {
  const test::TempFolder run;
  const auto views = render_views(run.path(), decomposed());
  write_strips(run.path(), views);
  const Image all = read_image(run / "strip.png", 3);
  for (const View& view : views) {
    const Image one = read_image(view_folder(run.path(), view.name) / "strip.png", 3);
    CHECK(one.width() == all.width());
    CHECK(one.height() < all.height());
  }
  CHECK(all.width() < 9 * kMinPanelWidth);  // a page has eight columns at most
  CHECK(strip_titles(run.path(), views).size() > 9);
}

TEST_CASE("errors are shown with the gain that the strip prints") {
  const test::TempFolder run;
  const auto views = render_views(run.path(), {});  // 0.5 for 0.6
  write_strips(run.path(), views);
  const Image strip = read_image(view_folder(run.path(), views[0].name) / "strip.png", 3);
  const int x = strip.width() * 5 / 10, y = strip.height() / 2;  // the third panel of five
  for (int c = 0; c < 3; ++c) CHECK(strip.at(x, y, c) == Approx(0.4f).margin(0.5 / 255));
}

TEST_CASE("depth has the scale of the true depths, whatever a method rendered") {
  const test::TempFolder run;
  auto views = render_views(run.path(), {});
  views[0].truth["depth"] = Image(kWidth, kHeight, 1, 1.5f);
  views[1].truth["behind_depth"] = Image(kWidth, kHeight, 1, 5.5f);
  views[1].truth["behind_depth"].at(0, 0) = 0;  // none
  const DepthScale scale = depth_scale({run.path()}, views);
  CHECK(scale.from_truth);
  CHECK(scale.low == 1.5f);
  CHECK(scale.high == 5.5f);
  const test::TempFolder other;
  render_views(other.path(), decomposed());
  CHECK(depth_scale({other.path()}, views).high == scale.high);
}

TEST_CASE("without true depths, the rendered ones give the scale") {
  const test::TempFolder run;
  auto views = render_views(run.path(), {});
  for (View& view : views) view.truth["depth"] = {};
  const DepthScale scale = depth_scale({run.path()}, views);
  CHECK_FALSE(scale.from_truth);
  CHECK(scale.low == 2.0f);
  CHECK(scale.high == 2.0f);
}

TEST_CASE("one stray depth in a hundred does not set the scale") {
  const test::TempFolder run;
  auto views = render_views(run.path(), {});
  views[0].truth["depth"].at(3, 3) = 1000.0f;
  views[0].truth["depth"].at(4, 4) = 0.01f;
  const DepthScale scale = depth_scale({run.path()}, views);
  CHECK(scale.low == 2.5f);
  CHECK(scale.high == 2.5f);
}

TEST_CASE("a map that one view lacks is a grey panel") {
  const test::TempFolder run;
  const auto views = render_views(run.path(), {});
  fs::remove(view_folder(run.path(), views[0].name) / "depth.exr");
  write_strips(run.path(), views);
  const Image strip = read_image(view_folder(run.path(), views[0].name) / "strip.png", 3);
  const int x = strip.width() * 7 / 10, y = strip.height() / 2;          // the fourth panel of five
  for (int c = 0; c < 3; ++c) CHECK(strip.at(x, y, c) == 128 / 255.0f);  // 127.5, to even
}
