// SPDX-License-Identifier: MIT
// How well the camera behind a plane explains photos (beyond the paper): all they show, of a
// mirror; of a pane what they show beside what is seen through it.
#pragma once

#include <vector>

#include "glint/scene/scene.h"
#include "glint/train/plane_mirrors.h"

namespace glint {

// A view as the sets show it without what its glass mirrors.
struct KnownView {
  const View* view;
  Image depth;    // [H][W][1] metres, of the interface
  Image without;  // [H][W][3] where nothing is mirrored
  Image share;    // [H][W][1] k_s
};

// Of a mirror: the mean correlation of photos with what the camera in it sees, in windows.
class MirrorLikeness {
 public:
  void add(const View& view, const MirrorView& mirror);
  // Sets likeness and tint; likeness is 0 below so many windows.
  void tell(MirrorPlane& plane, std::size_t least_windows) const;

 private:
  void add_window(const View& view, const MirrorView& mirror, int left, int top, int side);

  std::vector<double> correlations_;
  std::array<double, 3> photo_{}, mirrored_{};
};

// Of a pane: correlation, about the means of windows, of what photos have left with what its plane
// would add, k_s times what it mirrors; of both without what k_s alone explains (partial
// correlation), for rays are missing where k_s is high, whatever they should have brought.
class PaneLikeness {
 public:
  // seen: [H][W][1] above 0 where the plane is seen; mirrored: [H][W][3], left to right.
  void add(const KnownView& known, const Image& seen, const Image& mirrored);
  // 0 where what is left or mirrored does not vary, or k_s explains it.
  double partial_correlation() const;

 private:
  enum Quantity { kLeft, kMirrored, kShare, kCount };
  void add_window(
      const KnownView& known, const Image& seen, const Image& mirrored, int left, int top, int side
  );
  double correlation_of(Quantity a, Quantity b) const;

  double products_[kCount][kCount] = {};  // of what differs from a window's mean
};

}  // namespace glint
