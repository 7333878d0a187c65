// SPDX-License-Identifier: MIT
// Loops of SphericalLookup: mip levels and back, look-ups and back. The gradient of a texel is
// gathered from the look-ups that touch it, in the order of their pixels: no atomics.
#pragma once

#include "baselines/deferred/spherical_map.h"
#include "glint/core/kernel.h"
#include "glint/core/sorted.h"

namespace glint {

struct CopyValues {
  const float* from;
  float* to;
  GLINT_HD void operator()(std::size_t i) const { to[i] = from[i]; }
};
struct AddValues {
  const float* from;
  float* to;
  GLINT_HD void operator()(std::size_t i) const { to[i] += from[i]; }
};

// One value of a level from the level before: index of (texel of the level, channel).
struct BuildMapLevel {
  MapShape shape;
  int level;
  float* texels;  // all levels

  GLINT_HD void operator()(std::size_t i) const {
    const auto channels = static_cast<std::size_t>(shape.channels);
    const auto width = static_cast<std::size_t>(2 * shape.rows(level));
    const auto fine_width = static_cast<std::size_t>(2 * shape.rows(level - 1));
    const std::size_t texel = i / channels, row = texel / width, column = texel % width;
    const float* fine =
        texels + channels * (shape.first_texel(level - 1) + 2 * row * fine_width + 2 * column) +
        i % channels;
    const std::size_t down = channels * fine_width;
    texels[channels * shape.first_texel(level) + i] =
        0.25f * ((fine[0] + fine[channels]) + (fine[down] + fine[down + channels]));
  }
};
// Hands the gradient of `level` on to the level before: index of (texel of that one, channel).
struct BuildMapLevelVjp {
  MapShape shape;
  int level;
  float* dL_dtexels;  // all levels

  GLINT_HD void operator()(std::size_t i) const {
    const auto channels = static_cast<std::size_t>(shape.channels);
    const auto width = static_cast<std::size_t>(2 * shape.rows(level));
    const auto fine_width = static_cast<std::size_t>(2 * shape.rows(level - 1));
    const std::size_t texel = i / channels;
    const std::size_t row = texel / fine_width / 2, column = texel % fine_width / 2;
    // A last row that is odd has no coarser one.
    if (row >= static_cast<std::size_t>(shape.rows(level))) return;
    const std::size_t coarse = shape.first_texel(level) + row * width + column;
    dL_dtexels[channels * shape.first_texel(level - 1) + i] +=
        0.25f * dL_dtexels[channels * coarse + i % channels];
  }
};

struct LookUpMap {
  MapShape shape;
  const float *texels, *directions, *roughness;  // zero directions: nothing to look up
  float* values;                                 // [pixels][channels]

  GLINT_HD void operator()(std::size_t i) const {
    const Vec3f d = get3(directions, i);
    float* to = values + i * static_cast<std::size_t>(shape.channels);
    if (length2(d) == 0) {
      for (int c = 0; c < shape.channels; ++c) to[c] = 0;
      return;
    }
    const auto at = MapLookup<float>::of(shape, d, roughness[i]);
    for (int c = 0; c < shape.channels; ++c) to[c] = map_value(texels, shape, at, c);
  }
};

// dL/d(direction, roughness).
struct LookUpMapVjp {
  MapShape shape;
  const float *texels, *directions, *roughness, *dL_dvalues;
  float *dL_ddirections, *dL_droughness;

  GLINT_HD void operator()(std::size_t i) const {
    const Vec3f d = get3(directions, i);
    Vec3f dL_dd{};
    float dL_dlevel = 0;
    if (length2(d) > 0) {
      const auto at = MapLookup<float>::of(shape, d, roughness[i]);
      const float* g = dL_dvalues + i * static_cast<std::size_t>(shape.channels);
      Vec2f dL_duv{};
      for (int c = 0; c < shape.channels; ++c)
        map_value_vjp(texels, shape, at, c, g[c], dL_duv, dL_dlevel);
      lat_long_vjp(d, dL_duv, dL_dd);
      dL_dlevel *= at.level.slope;
    }
    put3(dL_ddirections, i, dL_dd);
    dL_droughness[i] = dL_dlevel;
  }
};

// Where the taps of each key begin among the sorted keys; the last entry: where they end.
struct FindTapBegins {
  const std::uint32_t* sorted;
  std::size_t count;
  std::uint32_t* begins;
  GLINT_HD void operator()(std::size_t key) const {
    begins[key] =
        static_cast<std::uint32_t>(first_at_least(sorted, count, static_cast<std::uint32_t>(key)));
  }
};

// What a look-up touches at one level: texels right of and below its key's, with these weights.
struct TexelWeights {
  float here, right, below, below_right;
};
// Two taps a pixel, one a level, each with the texel of its first row and column as its key;
// kNoTexel: none.
inline constexpr std::uint32_t kNoTexel = 0xffffffffu;
struct MapTaps {
  MapShape shape;
  const float *directions, *roughness;
  std::uint32_t* keys;    // [pixels][2]
  TexelWeights* weights;  // [pixels][2]

  GLINT_HD void operator()(std::size_t i) const {
    keys[2 * i] = keys[2 * i + 1] = kNoTexel;
    const Vec3f d = get3(directions, i);
    if (length2(d) == 0) return;
    const auto at = MapLookup<float>::of(shape, d, roughness[i]);
    put(2 * i, at.fine, 1 - at.level.weight);
    if (at.level.weight > 0) put(2 * i + 1, at.coarse, at.level.weight);
  }

 private:
  // Where latitude is clamped the row's weight is 0, and nothing is below.
  GLINT_HD void put(std::size_t i, const LevelTap<float>& tap, float weight) const {
    keys[i] = static_cast<std::uint32_t>(tap.texel(shape, tap.row.first, tap.column.first));
    const float below = weight * tap.row.weight, above = weight * (1 - tap.row.weight);
    const float right = tap.column.weight;
    weights[i] = {above * (1 - right), above * right, below * (1 - right), below * right};
  }
};

// Sorted taps [kTapWindow w, kTapWindow (w + 1)) of one key: the sums of their gradients by each of
// the four weights, index of (window, channel). Thousands of pixels may look at one texel of a
// coarse level, and one thread would add them up while the others of a GPU wait.
inline constexpr std::uint32_t kTapWindow = 64;
struct SumTapWindows {
  const float* dL_dvalues;
  const TexelWeights* weights;
  const std::uint32_t *sorted, *taps;  // keys, and whose they are
  std::size_t channels;
  float* windows;  // [windows][4][channels], those of several keys are not written

  GLINT_HD void operator()(std::size_t i) const {
    const std::size_t w = i / channels, c = i % channels, begin = w * kTapWindow;
    const std::uint32_t key = sorted[begin];
    if (key == kNoTexel || sorted[begin + kTapWindow - 1] != key) return;
    TexelWeights sum{};
    for (std::size_t t = begin; t < begin + kTapWindow; ++t) {
      const TexelWeights& weight = weights[taps[t]];
      const float g = dL_dvalues[taps[t] / 2 * channels + c];
      sum.here += weight.here * g;
      sum.right += weight.right * g;
      sum.below += weight.below * g;
      sum.below_right += weight.below_right * g;
    }
    float* to = windows + w * 4 * channels + c;
    to[0] = sum.here;
    to[channels] = sum.right;
    to[2 * channels] = sum.below;
    to[3 * channels] = sum.below_right;
  }
};

// Adds to the gradient of one texel what its look-ups give: index over texels of all levels, or
// over (texel, channel). A look-up that touches it has its key there, or one to the left, above, or
// both.
struct GatherMapTexels {
  MapShape shape;
  const float* dL_dvalues;
  const TexelWeights* weights;
  const std::uint32_t *begins, *taps;  // of key k: taps[begins[k]] ... before begins[k + 1]
  float* dL_dtexels;                   // all levels
  const float* windows = nullptr;      // of SumTapWindows; then the index has channels

  GLINT_HD void operator()(std::size_t i) const {
    const auto channels = static_cast<std::size_t>(shape.channels);
    if (windows == nullptr)
      each_corner(i, [&](auto... corner) { add(corner...); });
    else
      each_corner(i / channels, [&](auto... corner) { add_channel(i % channels, corner...); });
  }

 private:
  // f(texel, key, which weight, the weight) of the keys whose taps touch a texel.
  template <class F>
  GLINT_HD void each_corner(std::size_t i, F&& f) const {
    int level = 0;
    while (level + 1 < shape.levels && i >= shape.first_texel(level + 1)) ++level;
    const std::size_t first = shape.first_texel(level);
    const auto width = static_cast<std::size_t>(2 * shape.rows(level));
    const std::size_t row = (i - first) / width, column = (i - first) % width;
    const std::size_t left = i - column + (column + width - 1) % width;
    f(i, i, 0, &TexelWeights::here);
    f(i, left, 1, &TexelWeights::right);
    if (row == 0) return;
    f(i, i - width, 2, &TexelWeights::below);
    f(i, left - width, 3, &TexelWeights::below_right);
  }
  GLINT_HD void add(std::size_t texel, std::size_t key, int /*corner*/, float TexelWeights::*weight)
      const {
    const auto channels = static_cast<std::size_t>(shape.channels);
    float* to = dL_dtexels + texel * channels;
    for (std::uint32_t t = begins[key]; t < begins[key + 1]; ++t) {
      const float w = weights[taps[t]].*weight;
      const float* g = dL_dvalues + taps[t] / 2 * channels;
      for (std::size_t c = 0; c < channels; ++c) to[c] += w * g[c];
    }
  }
  // One channel, whole windows at a time. The sum is held here, as what is read might be it.
  GLINT_HD void add_channel(
      std::size_t c, std::size_t texel, std::size_t key, int corner, float TexelWeights::*weight
  ) const {
    const auto channels = static_cast<std::size_t>(shape.channels);
    float& to = dL_dtexels[texel * channels + c];
    float sum = to;
    const std::uint32_t stop = begins[key + 1];
    for (std::uint32_t t = begins[key]; t < stop; ++t) {
      if (t % kTapWindow == 0 && t + kTapWindow <= stop) {
        const std::size_t row = t / kTapWindow * 4 + static_cast<std::size_t>(corner);
        sum += windows[row * channels + c];
        t += kTapWindow - 1;
      } else {
        sum += weights[taps[t]].*weight * dL_dvalues[taps[t] / 2 * channels + c];
      }
    }
    to = sum;
  }
};

using SphericalMapKernels = KernelList<
    FindTapBegins,
    CopyValues,
    AddValues,
    BuildMapLevel,
    BuildMapLevelVjp,
    LookUpMap,
    LookUpMapVjp,
    MapTaps,
    SumTapWindows,
    GatherMapTexels>;

}  // namespace glint
