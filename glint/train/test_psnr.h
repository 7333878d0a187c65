// SPDX-License-Identifier: MIT
// PSNR of test views while a training goes on, for figures: methods are not told.
#pragma once

#include <vector>

#include "glint/method.h"

namespace glint {

inline constexpr std::size_t kMostTestPsnrViews = 8;

class TestPsnr {
 public:
  // After every so many steps and after the last; 0: never. `scene` outlives it.
  TestPsnr(const Scene& scene, int every);
  bool is_due(int iteration, int iterations) const;
  // Mean over at most kMostTestPsnrViews views, evenly chosen, rendered as `render` does. Not a
  // number: a picture is not finite.
  double measure(Method& method) const;

 private:
  std::vector<const View*> views_;
  int every_;
};

}  // namespace glint
