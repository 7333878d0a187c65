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
  float max_transparency = 0.5f;
  float min_cosine = 0.95f;  // between their normals

  GLINT_HD bool is_weak(float mirrored, float transparency) const {
    return mirrored < below && transparency < max_transparency;
  }
};

// The blocks of a picture.
struct ShareBlocks {
  static constexpr int kSide = 2;  // pixels, of a block
  int width, height;               // of the picture
  GLINT_HD int left_of(std::size_t i) const { return static_cast<int>(i) % width / kSide * kSide; }
  GLINT_HD int top_of(std::size_t i) const { return static_cast<int>(i) / width / kSide * kSide; }
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
    for (int y = top; y < top + ShareBlocks::kSide && y < blocks.height; ++y)
      for (int x = left; x < left + ShareBlocks::kSide && x < blocks.width; ++x) {
        const auto from = static_cast<std::uint32_t>(y * blocks.width + x);
        if (source[from] == i) f(from);
      }
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

using SharedRaysKernels = KernelList<ShareRays, SpreadColor, SpreadColorVjp>;

}  // namespace glint
