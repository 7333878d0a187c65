// SPDX-License-Identifier: MIT
#include "glint/drawing/picture_grid.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace glint;

namespace {

Image picture_of(const PictureGrid& grid) { return draw_image(draw_grid(grid)); }

PictureGrid one_panel() { return {{"one"}, {{Image(200, 150, 3)}}, {}}; }

}  // namespace

TEST_CASE("panels grow by whole numbers and shrink to a width that fits a page") {
  Image small(30, 20, 3);
  small.at(29, 19, 2) = 1;
  const Image large = fit_panel(small);
  CHECK(large.size() == ImageSize{210, 140});
  CHECK(large.at(203, 133, 2) == 1);
  CHECK(large.at(202, 133, 2) == 0);
  CHECK(fit_panel(Image(300, 100, 3)).size() == ImageSize{300, 100});
  CHECK(fit_panel(Image(1920, 1080, 3)).size() == ImageSize{480, 270});
  CHECK(fit_panel(Image(9000, 1, 3)).size() == ImageSize{480, 1});
}

TEST_CASE("every pixel of a panel is a pixel of the picture") {
  Image panel(300, 200, 3, 0.25f);
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 300; ++x)
      panel.at(x, y, 0) = static_cast<float>((x * 7 + y * 13) % 256) / 255;
  const Image picture = picture_of({{"a", "b", "c"}, {{panel, panel, panel}}, {}, {"a row"}});
  int found = 0;
  for (int top = 0; top + 200 <= picture.height(); ++top)
    for (int left = 0; left + 300 <= picture.width(); ++left) {
      bool same = true;
      for (int i = 0; i < 200 && same; ++i)
        same = std::abs(picture.at(left + i, top + i, 0) - panel.at(i, i, 0)) < 1e-3f &&
               std::abs(picture.at(left + 299 - i, top + i, 0) - panel.at(299 - i, i, 0)) < 1e-3f;
      found += same;
    }
  CHECK(found == 3);
}

TEST_CASE("a grid is as wide as a page, narrower of few pixels, wider of many columns") {
  const auto width = [](std::size_t columns, int pixels) {
    const PanelRow row(columns, Image(pixels, pixels / 2, 3));
    return draw_grid({std::vector<std::string>(columns, "title"), {row}, {}}).width;
  };
  CHECK(width(4, 480) == Approx(504));
  CHECK(width(8, 480) == Approx(504));
  CHECK(width(2, 200) < 200);
  CHECK(width(14, 480) > 700);
}

TEST_CASE("in bands, columns that do not fit the page stand below the others") {
  const auto drawn = [](std::size_t columns, bool bands) {
    PictureGrid grid{std::vector<std::string>(columns, "title"), {}, {}};
    for (int row = 0; row < 2; ++row) grid.rows.emplace_back(columns, Image(480, 240, 3, 0.75f));
    grid.bands = bands;
    return draw_grid(std::move(grid));
  };
  CHECK(drawn(8, true).height == Approx(drawn(8, false).height));
  const Drawing folded = drawn(18, true);  // three bands of six
  CHECK(folded.width == Approx(504));
  CHECK(folded.height == Approx(3 * drawn(6, false).height).epsilon(0.04));  // margins once
  const Image picture = draw_image(folded);
  double panels = 0;  // no panel is lost or covered
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      panels += std::abs(picture.at(x, y, 0) - 0.75f) < 0.01f;
  CHECK(panels == Approx(36 * 480 * 240).epsilon(0.02));
}

TEST_CASE("columns that belong together stand in one band") {
  const auto drawn = [](const std::set<std::size_t>& joined) {
    PictureGrid grid{std::vector<std::string>(16, "title"), {}, {}};
    grid.rows.emplace_back(16, Image(480, 240, 3, 0.75f));
    grid.bands = true;
    grid.joined = joined;
    return draw_grid(std::move(grid));
  };
  CHECK(drawn({}).width == Approx(504));           // two bands of eight
  CHECK(drawn({7}).width == drawn({}).width);      // no band begins there
  CHECK(drawn({8}).width > drawn({}).width + 10);  // seven, nine
  CHECK(drawn({8}).height > 0.8 * drawn({}).height);
  std::set<std::size_t> all;
  for (std::size_t column = 1; column < 16; ++column) all.insert(column);
  CHECK(drawn(all).height < 0.6 * drawn({}).height);  // one band
}

TEST_CASE("titles of rows stand left of the panels, long ones are broken") {
  PictureGrid grid = one_panel();
  const Drawing plain = draw_grid(grid);
  grid.row_titles = {"room_1\ndepth"};
  const double titled = draw_grid(grid).width;
  CHECK(titled > plain.width + 15);
  const Image picture = draw_image(draw_grid(grid));
  CHECK(picture.at(picture.width() - 100, picture.height() / 2) == 0);  // the black panel
  grid.row_titles = {std::string(20, 'w') + " " + std::string(20, 'w')};
  CHECK(draw_grid(grid).width > titled);
  CHECK(draw_grid(grid).width < plain.width + 100);
}

TEST_CASE("titles above are broken into lines, which need room") {
  PictureGrid grid = one_panel();
  const Drawing one = draw_grid(grid);
  grid.titles = {"a title of many words that no line of this width has room for"};
  const Drawing two = draw_grid(grid);
  CHECK(two.width == one.width);
  CHECK(two.height > one.height + 8);
}

TEST_CASE("a legend longer than the panels widens the page, one longer than the page is broken") {
  PictureGrid grid = one_panel();
  const double narrow = draw_grid(grid).width;
  grid.legend = {{"somewhat longer than the only panel, but not very much"}};
  CHECK(draw_grid(grid).width > narrow);
  const double line = draw_grid(grid).height;
  grid.legend = {{std::string(100, 'w') + " " + std::string(100, 'w')}};
  CHECK(draw_grid(grid).width == Approx(504));
  CHECK(draw_grid(grid).height > line + 5);
}

TEST_CASE("a bar of the legend has the colours of its map, between its words") {
  PictureGrid grid = one_panel();
  const Drawing plain = draw_grid(grid);
  grid.legend = {{"0", LegendBar::kError, "1"}};
  const Drawing with_bar = draw_grid(grid);
  CHECK(with_bar.height > plain.height + 5);
  const Image picture = draw_image(with_bar);
  int orange = 0;  // magma has it, neither panel nor letters do
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      orange += picture.at(x, y, 0) > 0.95f && picture.at(x, y, 1) < 0.8f &&
                picture.at(x, y, 1) > 0.5f && picture.at(x, y, 2) < 0.6f;
  CHECK(orange > 100);
}

TEST_CASE("what is missing is grey and says so") {
  const Image picture = picture_of({{"one", "two"}, {{Image(200, 150, 3), Image()}}, {}});
  const int right = picture.width() - 20;
  CHECK(picture.at(right, picture.height() - 30, 0) == 128 / 255.0f);
  int light = 0;
  for (int y = 60; y < picture.height() - 20; ++y)
    for (int x = picture.width() / 2 + 10; x < right; ++x) light += picture.at(x, y, 0) > 0.9f;
  CHECK(light > 50);
}

TEST_CASE("without rows there is no drawing") { CHECK(draw_grid({{"one"}, {}, {}}).empty()); }
