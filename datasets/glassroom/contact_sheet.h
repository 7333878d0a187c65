// SPDX-License-Identifier: MIT
// One picture that shows a scene: a column per view; rows for the image, every true map of the
// table (glint/scene/maps.h) and every simulated prior. A map that is zero in all views shown, as
// the fourth layer mostly is, has no row.
#pragma once

#include "datasets/glassroom/path_tracer.h"
#include "glint/drawing/picture_grid.h"
#include "glint/scene/scene.h"

namespace glint {

class ContactSheet {
 public:
  // Up to `columns` of `views` views are shown, evenly chosen; tiles are `tile` pixels.
  // `far_depth`: metres, end of the depth colours.
  ContactSheet(int views, int columns, ImageSize tile, float far_depth);
  // Keeps the view if it is one of those shown.
  void add(int view, const PathTracerOutput& truth, const MapSet& priors, float exposure);
  // With titles of rows and columns. A view that was not added is "missing".
  ByteImage image() const;

 private:
  int views_, columns_;
  ImageSize tile_;
  float far_depth_;
  PictureGrid grid_;
  std::vector<bool> says_anything_;  // of each row
};

}  // namespace glint
