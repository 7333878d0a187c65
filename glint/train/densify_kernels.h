// SPDX-License-Identifier: MIT
// Statistics of density control, per surfel and view.
#pragma once

#include <cstdint>

#include "glint/core/kernel.h"
#include "glint/core/vec.h"

namespace glint {

struct DensifyStatistics {
  float* gradient_sums;                    // [N]
  float* weight_sums;                      // [N] of the surfel's weights in pixels or rays
  std::uint32_t* views;                    // [N] in which the surfel was seen
  const std::uint32_t* is_void = nullptr;  // void_steps.h; null: no

  GLINT_HD void add(std::size_t i, float gradient, float weight) const {
    if (is_void != nullptr && *is_void != 0) return;
    gradient_sums[i] += gradient;
    weight_sums[i] += weight;
    ++views[i];
  }
};

struct ObserveRaster {
  DensifyStatistics statistics;
  const std::uint8_t* in_view;  // [N]
  const float* screen;          // [N][2]
  const float* more;            // the same of a second rasterisation, added to it; null: none
  const float* visibility;      // [N]; null: not known
  float scale;
  bool only_weighted;

  GLINT_HD void operator()(std::size_t i) const {
    if (in_view[i] == 0) return;
    const float weight = visibility != nullptr ? visibility[i] : 0.0f;
    if (only_weighted && visibility != nullptr && weight <= 0) return;
    float x = screen[2 * i], y = screen[2 * i + 1];
    if (more != nullptr) {
      x += more[2 * i];
      y += more[2 * i + 1];
    }
    statistics.add(i, scale * hypotf(x, y), weight);
  }
};

// What PGSR watches besides: the mean norm of the absolute gradient and the largest radius, both at
// the published image height (scale: rows over that height).
struct ObserveFootprint {
  const std::uint8_t* in_view;  // [N]
  const float* screen_abs;      // [N][2]
  const float* radii;           // [N] pixels
  const float* owned_pixels;    // [N]: radii count where it owns one
  float scale;
  float *gradient_sums, *max_radii;        // [N]
  const std::uint32_t* is_void = nullptr;  // void_steps.h; null: no

  GLINT_HD void operator()(std::size_t i) const {
    if (in_view[i] == 0 || (is_void != nullptr && *is_void != 0)) return;
    gradient_sums[i] += scale * hypotf(screen_abs[2 * i], screen_abs[2 * i + 1]);
    if (owned_pixels[i] > 0) max_radii[i] = max_of(max_radii[i], radii[i] / scale);
  }
};

// Of one column of [N][width].
struct LowerColumn {
  std::size_t column, width;
  float highest;
  float* values;
  GLINT_HD void operator()(std::size_t i) const {
    float& value = values[i * width + column];
    value = min_of(value, highest);
  }
};
struct ClearColumn {
  std::size_t column, width;
  float* values;
  GLINT_HD void operator()(std::size_t i) const { values[i * width + column] = 0; }
};

// Log scales above the highest are lowered to it, and their moments forgotten.
struct LimitScales {
  float highest;
  float *log_scales, *first, *second;  // [N][2]
  GLINT_HD void operator()(std::size_t i) const {
    if (log_scales[i] <= highest) return;
    log_scales[i] = highest;
    first[i] = second[i] = 0;
  }
};

// |v| without overflow of the squares.
GLINT_HD float safe_length(Vec3f v) {
  const float x = abs_of(v.x), y = abs_of(v.y), z = abs_of(v.z);
  const float a = max_of(max_of(x, y), z);
  if (!(a > 0)) return a;
  return a * sqrt_of(square(x / a) + square(y / a) + square(z / a));
}

struct ObserveTrace {
  DensifyStatistics statistics;
  const float* visibility;   // [N]
  const float* half_depths;  // [N][3]
  float scale;

  GLINT_HD void operator()(std::size_t i) const {
    if (visibility[i] <= 0) return;
    const float* g = half_depths + 3 * i;
    statistics.add(i, scale * safe_length({g[0], g[1], g[2]}), visibility[i]);
  }
};

// Whether a view sees a surfel: it owns a pixel there (RasterOutput::owned_pixels).
struct CountObservations {
  const float* owned_pixels;  // [N]
  std::uint32_t* views;       // [N] added to

  GLINT_HD void operator()(std::size_t i) const { views[i] += owned_pixels[i] > 0 ? 1 : 0; }
};

using DensifyKernels = KernelList<
    ObserveRaster,
    ObserveFootprint,
    ObserveTrace,
    CountObservations,
    LowerColumn,
    ClearColumn,
    LimitScales>;

}  // namespace glint
