// SPDX-License-Identifier: MIT
// SharedRays, pixel by pixel.
#pragma once

#include <cstdint>

#include "glint/core/kernel.h"
#include "glint/core/vec.h"

namespace glint {

// Which pixels can do with a neighbour's mirrored ray.
struct RaySharing {
  float below = 0;  // k_s; 0: none
  int block = 2;    // pixels, across and down, of which one has the ray of all; at least 1
  float max_transparency = 0.5f;
  float min_cosine = 0.95f;  // between their normals

  GLINT_HD bool is_weak(float mirrored, float transparency) const {
    return mirrored < below && transparency < max_transparency;
  }
};

// Where the rays end of pixels that mirror little: at the transmittance whose share of the pixel
// is `weight_below`, within these bounds. Also a pixel with k_s = 0 has a ray, since k_s is learned
// from what that sees.
struct RayStops {
  float weight_below = 0;                 // transmittance times k_s; 0: at `latest`, all of them
  float earliest = 0.3f, latest = 0.02f;  // transmittance

  GLINT_HD float at(float mirrored) const {
    const float limit = weight_below / max_of(mirrored, 1e-6f);
    return max_of(latest, min_of(earliest, limit));
  }
};

// The blocks of a picture.
struct ShareBlocks {
  int width, height;  // of the picture
  int side;           // of a block
  GLINT_HD int left_of(std::size_t i) const { return static_cast<int>(i) % width / side * side; }
  GLINT_HD int top_of(std::size_t i) const { return static_cast<int>(i) / width / side * side; }
};

// The pixel of a block whose ray the others take.
struct LeaderOfBlock {
  ShareBlocks blocks;
  int x, y;  // its place in the block
  GLINT_HD std::uint32_t of(std::size_t i) const {
    const int column = blocks.left_of(i) + x, row = blocks.top_of(i) + y;
    return static_cast<std::uint32_t>(
        (row < blocks.height ? row : blocks.height - 1) * blocks.width +
        (column < blocks.width ? column : blocks.width - 1)
    );
  }
};

// source: of each pixel the one whose ray it takes, perhaps itself; others have no direction.
struct ShareRays {
  LeaderOfBlock leader;
  RaySharing sharing;
  const float *mirrored, *transparency, *normal, *directions;  // of a GlassBuffer
  std::uint32_t* source;
  float* shared;

  GLINT_HD void operator()(std::size_t i) const {
    const std::uint32_t other = leader.of(i);
    const bool alike = dot(get3(normal, i), get3(normal, other)) >= sharing.min_cosine;
    const bool takes = other != i && alike && sharing.is_weak(mirrored[i], transparency[i]);
    source[i] = takes ? other : static_cast<std::uint32_t>(i);
    put3(shared, i, takes ? Vec3f{} : get3(directions, i));
  }
};

// Pixels of i's block whose ray is i's, as f(pixel).
struct SharersOf {
  ShareBlocks blocks;
  const std::uint32_t* source;

  template <class F>
  GLINT_HD void each(std::size_t i, F&& f) const {
    if (source[i] != i) return;
    const int left = blocks.left_of(i), top = blocks.top_of(i);
    for (int y = top; y < top + blocks.side && y < blocks.height; ++y)
      for (int x = left; x < left + blocks.side && x < blocks.width; ++x) {
        const auto from = static_cast<std::uint32_t>(y * blocks.width + x);
        if (source[from] == i) f(from);
      }
  }
};

// A ray goes as far as the pixel needs it that mirrors most of those that take it.
struct StopRays {
  SharersOf sharers;
  RayStops stops;
  const float* mirrored;
  float* out;

  GLINT_HD void operator()(std::size_t i) const {
    float most = 0;
    sharers.each(i, [&](std::uint32_t pixel) { most = max_of(most, mirrored[pixel]); });
    out[i] = stops.at(most);
  }
};

struct SpreadColor {
  const std::uint32_t* source;
  const float* traced;
  float* color;
  GLINT_HD void operator()(std::size_t i) const { put3(color, i, get3(traced, source[i])); }
};
// A pixel's own ray gets what all that took it are due.
struct SpreadColorVjp {
  SharersOf sharers;
  const float* dL_dcolor;
  float* dL_dtraced;
  GLINT_HD void operator()(std::size_t i) const {
    Vec3f sum{};
    sharers.each(i, [&](std::uint32_t pixel) { sum += get3(dL_dcolor, pixel); });
    put3(dL_dtraced, i, sum);
  }
};

using SharedRaysKernels = KernelList<ShareRays, StopRays, SpreadColor, SpreadColorVjp>;

}  // namespace glint
