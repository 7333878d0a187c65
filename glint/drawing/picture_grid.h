// SPDX-License-Identifier: MIT
// Pictures in rows and columns with titles above and a legend below, to look at.
#pragma once

#include <array>
#include <set>
#include <string>
#include <vector>

#include "glint/drawing/canvas.h"
#include "glint/scene/image_files.h"

namespace glint {

// fit_panel() enlarges to at least the first, by whole numbers, and shrinks to at most the second.
inline constexpr int kMinPanelWidth = 200, kMaxPanelWidth = 480;  // pixels

// The colours of a map from low to high, as layer_picture() and the strips show it; or what stands
// for a pixel without a value.
enum class LegendBar { kNone, kDepth, kShare, kError, kHatch, kGrey };

// Of a pixel that is there but does not count: pale blue stripes, which no map of errors has.
std::array<float, 3> hatch_color(int x, int y);
inline constexpr float kNothingGrey = 0.5f;  // of what is not there, "missing" panels included

struct LegendLine {
  std::string text;
  LegendBar bar = LegendBar::kNone;  // behind the text
  std::string rest;                  // behind the bar
};

// A picture [h][w][1 or 3] as displayed, in bytes: a page of figures holds hundreds.
class Panel {
 public:
  Panel() = default;
  Panel(const Image& picture) : bytes_(to_bytes(picture)) {}

  bool empty() const { return bytes_.empty(); }
  ImageSize size() const { return bytes_.size(); }
  const ByteImage& bytes() const { return bytes_; }

 private:
  ByteImage bytes_;
};
using PanelRow = std::vector<Panel>;

struct PictureGrid {
  std::vector<std::string> titles;  // one a column
  std::vector<PanelRow> rows;       // empty panel: "missing"
  std::vector<LegendLine> legend;
  std::vector<std::string> row_titles = {};  // left of the rows, '\n' between lines; none: no room
  bool bands = false;  // columns that do not fit the page stand below the others, all rows of them
  std::set<std::size_t> joined = {};  // columns that stand in the band of the one before them
};

Image fit_panel(const Image& panel);

// A page as wide as that of a paper, or narrower where the panels have few pixels, or wider where
// there are many columns, each as wide as the widest panel. Its picture shows every pixel of a
// panel as one pixel. Titles and legends are broken into lines that fit. Empty: there is no row.
Drawing draw_grid(PictureGrid grid);

}  // namespace glint
