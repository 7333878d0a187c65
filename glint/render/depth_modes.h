// SPDX-License-Identifier: MIT
// Depths of the first and of the last of several layers along a ray, without training for it
// [Xu26, TSPE-GS]; for output only, without gradient. Rasterizer::depth_modes() makes the maps.
//
// The published method takes depths at many transmittances, uniformly spaced: samples whose density
// over depth is that of the blending weights w = T alpha. Here that density is made of the hits
// themselves, D(z) = sum_i w_i max(0, 1 - |z_i - z| / (width z)), looked at at each hit, where its
// maxima are, and halfway between neighbours. A maximum is a mode of its own where D falls below
// `valley` times the lower of two before the next. Its depth is the weighted mean of the hits
// within `width` of it; where those have less than `share` of the pixel's weight, it is none.
//
// Deviation: the official code finds maxima of the density of the sampled maps' mean depths, once
// per image, and takes the maps at those transmittances: layers that have another transmittance in
// another part of the picture are not found. Here each pixel has its own.
#pragma once

#include "glint/render/first_surface.h"

namespace glint {

struct DepthModeSettings {
  float width = 0.02f;  // half the kernel's, as a share of depth
  float valley = 0.5f;  // of the lower maximum
  float share = 0.05f;  // of the weights' sum
};

struct DepthModes {
  float first = 0, last = 0;  // metres; 0: none. The same where there is one alone
};

// One pixel's search, front to back.
class ModeSearch {
 public:
  GLINT_HD ModeSearch(const SurfaceHits& hits, const DepthModeSettings& settings)
      : hits_(hits), settings_(settings) {
    for (int i = 0; i < hits.count; ++i) least_ += settings.share * hits.weights[i];
  }

  GLINT_HD DepthModes run() {
    for (int i = 0; i < hits_.count; ++i) {
      if (i > 0) look_at(0.5f * (hits_.depths[i - 1] + hits_.depths[i]));
      look_at(hits_.depths[i]);
    }
    end_mode();
    return found_;
  }

 private:
  struct Place {
    float depth = 0, density = 0;
    float weight = 0, offset = 0;  // of hits in reach: sum of w and of w (z - depth)
  };

  GLINT_HD Place place_at(float depth) {
    Place place{depth};
    const float reach = settings_.width * depth;
    while (begin_ < hits_.count && hits_.depths[begin_] < depth - reach) ++begin_;
    for (int i = begin_; i < hits_.count && hits_.depths[i] <= depth + reach; ++i) {
      const float offset = hits_.depths[i] - depth, weight = hits_.weights[i];
      place.density += weight * max_of(0.0f, 1 - abs_of(offset) / reach);
      place.weight += weight;
      place.offset += weight * offset;
    }
    return place;
  }
  // A maximum ends where the ground has risen from a valley behind it.
  GLINT_HD void look_at(float depth) {
    const Place place = place_at(depth);
    lowest_ = min_of(lowest_, place.density);
    if (lowest_ < settings_.valley * min_of(highest_.density, place.density)) end_mode();
    if (place.density <= highest_.density) return;
    highest_ = place;
    lowest_ = place.density;
  }
  GLINT_HD void end_mode() {
    if (highest_.weight > 0 && highest_.weight >= least_) {
      found_.last = highest_.depth + highest_.offset / highest_.weight;
      if (found_.first == 0) found_.first = found_.last;
    }
    highest_ = {};
  }

  const SurfaceHits& hits_;
  const DepthModeSettings& settings_;
  float least_ = 0;   // weight of a mode
  int begin_ = 0;     // first hit in reach of the place looked at
  Place highest_;     // since the last mode ended
  float lowest_ = 0;  // density since then
  DepthModes found_;
};

}  // namespace glint
