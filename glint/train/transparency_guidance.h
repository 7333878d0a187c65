// SPDX-License-Identifier: MIT
// Bootstrapped transparency [Na26 Eq. 13, 14]: where the interface and what is seen through it lie
// apart, and the prior's diffuse albedo is dark, the transparency map t is drawn to 1, elsewhere to
// 0. Two kinds: the paper's L1 on a binary mask, and the release's cross-entropy on two masks.
#pragma once

#include "glint/core/image.h"
#include "glint/scene/camera.h"

namespace glint {

enum class GuidanceKind { kL1, kBce };

// What the masks are made from; constants, no gradient flows to them.
struct TransparencyCues {
  BorrowedImage interface_depth;     // [H][W][1] planar z, 0: none
  BorrowedImage transmission_depth;  // [H][W][1] planar z of the transmission set seen from the
                                     // camera on its own (not only behind the interface), 0: none
  BorrowedImage albedo;              // [H][W][3] the prior's diffuse albedo as stored
  BorrowedImage basecolor;           // [H][W][3] the prior's; kBce only
  BorrowedImage cosine;              // [H][W][1] of viewing_cosines(), empty for 1; kBce only
  BorrowedImage counted;             // [H][W][1] View::counted; empty: all pixels count
};

// [H][W][1] weights in [0, 1], for the loss and for figures. Empty: no guidance for this view; kL1
// without `opaque`: what is not transparent is opaque.
struct TransparencyMasks {
  Image transparent, opaque;
  Image labelled_opaque;  // kBce: before erosion and weights
};

// kL1: transparent = |z_intr - z_trans| > depth_threshold and mean RGB albedo < low_albedo, and 0
// where a depth is missing; opaque = 1 - transparent; loss = mean |transparent - t|, over all
// pixels; one that does not count is neither, and adds nothing. An L1 takes what most labels say:
// with `transparent_weight` w, a surface becomes transparent where more than 1 / (1 + w) of its
// labels say so.
//
// kBce: transparent = low albedo, bright basecolor, both depths present and
// z_trans > z_intr + depth_threshold; opaque = high albedo, or low albedo and basecolor not bright,
// or z_trans <= z_intr + depth_threshold (a missing z_trans included). Both are eroded by a 3x3
// minimum, then multiplied by a weight that falls from 1 at 70 degrees to 0 at 80 between ray and
// normal. Loss = weighted mean of BCE(t, transparent_target) + weighted mean of
// BCE(t, opaque_target); t is clamped to [1e-6, 1 - 1e-6], without gradient beyond.
// Deviation: two parts of the release's kBce are left out: weights by how much transmission
// explains the photograph, and a term on the prior's depth minus the rendered depth, which compares
// a relative depth with metres.
struct TransparencyGuidance {
  GuidanceKind kind = GuidanceKind::kL1;
  float depth_threshold = 0.01f;   // tau_d, metres (scale it for scenes in other units)
  float low_albedo = 0.05f;        // gamma_a
  float transparent_weight = 1;    // kL1, of labels that say transparent, beside 1
  float high_albedo = 0.10f;       // kBce
  float bright_basecolor = 0.25f;  // kBce, of the mean RGB
  float transparent_target = 0.98f, opaque_target = 0.02f;  // kBce

  // kL1: more than this share of a surface's labels have to say transparent.
  double share_needed() const { return 1 / (1 + static_cast<double>(transparent_weight)); }

  static TransparencyGuidance paper() { return {}; }
  static TransparencyGuidance release() { return {GuidanceKind::kBce, 0.005f}; }

  // [H][W][1] 0 where labels do not depend on depths; empty: they may everywhere.
  void mark_needed_depths(const Image& albedo, Image& needed) const;
  // Empty masks when a cue that the kind needs is missing.
  void label(const TransparencyCues& cues, TransparencyMasks& masks) const;
  TransparencyMasks masks(const TransparencyCues& cues) const {
    TransparencyMasks result;
    label(cues, result);
    return result;
  }
  // transparency: t [H][W][1]. Adds weight * gradient to dL_dtransparency and returns the
  // unweighted loss; empty masks give 0.
  template <class T>
  double evaluate(
      const BasicImage<T>& transparency,
      const TransparencyMasks& masks,
      T weight,
      BasicImage<T>& dL_dtransparency
  ) const;

 private:
  void label_pixels(const TransparencyCues& cues, TransparencyMasks& masks) const;
};

// |cos| of the angle between each pixel's ray and its composited normal ([H][W][3], camera space);
// 0 where there is no normal.
Image viewing_cosines(const Camera& camera, const Image& normal);

}  // namespace glint
