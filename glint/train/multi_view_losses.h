// SPDX-License-Identifier: MIT
// Multi-view regularisation of planes [Chen24 Sec. 4.3]: a view and one neighbour, both rendered,
// agree in depth (reprojection, Eq. 12) and, warped by each pixel's plane, in the pictures (Eq.
// 13).
#pragma once

#include <cstdint>

#include "glint/scene/camera.h"
#include "glint/train/counted_pixels.h"
#include "glint/train/multi_view_kernels.h"

namespace glint {

struct MultiViewWeights {
  float geometric = 0.03f;
  float photometric = 0.15f;
};
struct MultiViewSettings {
  float min_z = 0.1f;                // metres: nearer points do not count
  float max_error = 1;               // pixels: pixels that land farther away are occluded
  float max_dissimilarity = 0.9f;    // 1 - NCC^2 above: not the same thing
  std::size_t max_patches = 102400;  // a step
};

// A rendered view. depth: plane depth, [H][W][1]; 0: none. gray: the photo by gray_of().
struct PlanarView {
  const Camera& camera;
  const Image& depth;
  const Image& gray;
};

struct MultiViewTerms {
  double geometric = 0;    // mean of w e, pixels
  double photometric = 0;  // mean of w (1 - NCC^2)
  double num_pixels = 0, num_patches = 0;
};

class MultiViewLosses {
 public:
  MultiViewSettings settings;

  // normal, distance: of the reference, as composited ([H][W][3], [H][W][1]). Adds the weighted
  // gradients; those of the depth maps are of the geometric term, those of normal and distance of
  // the photometric one. seed: which patches, where there are more than max_patches. Deviation:
  // that many on average, as every pixel is drawn on its own.
  MultiViewTerms evaluate(
      const PlanarView& reference,
      const PlanarView& neighbor,
      const Image& normal,
      const Image& distance,
      MultiViewWeights weights,
      std::uint32_t seed,
      Image& dL_ddepth,
      Image& dL_dneighbor_depth,
      Image& dL_dnormal,
      Image& dL_ddistance
  );

 private:
  double geometric(
      const PlanarView& reference,
      const PlanarView& neighbor,
      float weight,
      Image& dL_ddepth,
      Image& dL_dneighbor_depth,
      MultiViewTerms& terms
  );

  Image weight_, depth_gradient_, normal_gradient_, distance_gradient_;
  FixedArray neighbor_gradient_;
  Array<CountedSum> geometric_, photometric_;  // [1] each, as those below
  Array<double> scale_;
  Array<PixelSample> sample_;
};

// 0.299 R + 0.587 G + 0.114 B, [H][W][1]; kNoGray where a pixel does not count.
Image gray_of(const Photo& photo);

}  // namespace glint
