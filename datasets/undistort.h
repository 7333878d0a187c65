// SPDX-License-Identifier: MIT
// Undoes lens distortion (OpenCV's radial-tangential model). The focal length stays; the picture is
// cropped to the rectangle that the photograph fills, so no invented pixel is trained on.
#pragma once

#include <span>
#include <vector>

#include "glint/scene/camera.h"

namespace glint {

class Undistortion {
 public:
  // `distortion`: k1 k2 p1 p2 [k3]. `camera`: size and intrinsics of the photograph.
  // Errors (kBadReference): the undistorted picture has no usable rectangle.
  Undistortion(const Camera& camera, std::span<const double> distortion);

  const Camera& camera() const { return camera_; }  // of the result

  enum class Lookup { kBilinear, kNearest };
  Image apply(ImageView image, Lookup lookup) const;

 private:
  void crop_to_photograph(ImageSize photograph);
  bool inside(std::size_t pixel, ImageSize photograph) const;

  Camera camera_;
  int full_width_ = 0, left_ = 0, top_ = 0;  // of the crop
  std::vector<float> from_x_, from_y_;  // [H][W] position in the photograph, centres at integers
};

}  // namespace glint
