// SPDX-License-Identifier: MIT
// One picture that shows a scene: a column per view; rows for the image, every true map of the
// table (glint/scene/maps.h) and every simulated prior.
#pragma once

#include "datasets/glassroom/path_tracer.h"
#include "glint/scene/scene.h"

namespace glint {

class ContactSheet {
 public:
  // Up to `columns` of `views` views are shown, evenly chosen; tiles are `tile` pixels.
  ContactSheet(int views, int columns, ImageSize tile);
  // Draws the view if it is one of those shown.
  void add(int view, const PathTracerOutput& truth, const MapSet& priors, float exposure);
  const Image& image() const { return image_; }

 private:
  void paste(int column, int row, ImageView picture);

  int views_, columns_;
  ImageSize tile_;
  Image image_;
};

}  // namespace glint
