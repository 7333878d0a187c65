// SPDX-License-Identifier: MIT
// How far the truth of test views is from itself: the noise of their samples bounds every score.
#pragma once

#include "datasets/glassroom/path_tracer.h"
#include "glint/core/config.h"

namespace glint {

class NoiseFloor {
 public:
  // Of a view with halves; another one counts for nothing.
  void add(const PathTracerOutput& truth, float exposure);
  // {"views", "rgb": {"standard_error", "psnr"}, "path_t": ...}; null without views.
  //   standard_error   root mean square of half the difference of the two halves of the samples,
  //                    linear and exposed, over pixels whose first surface is glass or a mirror (of
  //                    the image: all; of transmitted and reflected: glass)
  //   psnr             dB of the truth against the limit of many samples, as scores compare: the
  //                    displayed pixel times the part's share of its radiance; absent where no
  //                    sample differs
  Json json() const;

 private:
  struct Sums {
    double linear = 0, displayed = 0;  // of squares
    std::size_t count = 0;
  };
  BasicMapSet<std::vector<Sums>> sums_;  // one of each map
  int views_ = 0;
};

}  // namespace glint
