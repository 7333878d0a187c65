// SPDX-License-Identifier: MIT
// The photometric loss (photometric.h), a thread a pixel; the CPU goes along rows with vectors
// (photometric.cpp). The window is separable: along x, then along y. Planes [H][W] of moments lie
// one behind the other: [5][3 colours], of their gradients [3][3 colours].
#pragma once

#include "glint/core/image.h"
#include "glint/core/kernel.h"
#include "glint/render/ssim_formula.h"
#include "glint/train/pixel_losses.h"

namespace glint {

struct SsimWindow {
  float weights[kSsimTaps];
};
enum MomentPlane { kMuX, kMuY, kXx, kYy, kXy, kMomentPlanes };
inline constexpr int kGradientPlanes = 3;  // of mu_x, xx, xy

struct PlaneStack {
  int width, height;
  GLINT_HD std::size_t size() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  GLINT_HD std::size_t at(int plane, int color, int x, int y) const {
    return static_cast<std::size_t>(3 * plane + color) * size() +
           static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

// Along x: the five moments of each colour. Element i = (colour, pixel).
struct BlurMomentRows {
  ImageView rendered, target;
  SsimWindow window;
  PlaneStack planes;
  float* moments;

  GLINT_HD void operator()(std::size_t i) const {
    const int color = static_cast<int>(i / planes.size());
    const int pixel = static_cast<int>(i % planes.size());
    const int x = pixel % planes.width, y = pixel / planes.width;
    float sums[kMomentPlanes] = {};
    for (int k = 0; k < kSsimTaps; ++k) {
      const int at = x + k - kSsimRadius;
      if (at < 0 || at >= planes.width) continue;
      const float a = rendered.at(at, y, color), b = target.at(at, y, color);
      const float values[kMomentPlanes] = {a, b, a * a, b * b, a * b};
      for (int plane = 0; plane < kMomentPlanes; ++plane)
        sums[plane] = fma_of(window.weights[k], values[plane], sums[plane]);
    }
    for (int plane = 0; plane < kMomentPlanes; ++plane)
      moments[planes.at(plane, color, x, y)] = sums[plane];
  }
};

// The window along y of one plane at one pixel.
GLINT_HD float blur_column(
    const float* stack,
    const PlaneStack& planes,
    const SsimWindow& window,
    int plane,
    int color,
    int x,
    int y
) {
  float sum = 0;
  for (int k = 0; k < kSsimTaps; ++k) {
    const int at = y + k - kSsimRadius;
    if (at < 0 || at >= planes.height) continue;
    sum = fma_of(window.weights[k], stack[planes.at(plane, color, x, at)], sum);
  }
  return sum;
}

// Along y, the formula and its derivatives: the sum of SSIM over colours.
struct SsimAt {
  SsimWindow window;
  PlaneStack planes;
  const float* moments;
  float* gradients;

  GLINT_HD double operator()(int x, int y) const {
    double sum = 0;
    for (int color = 0; color < 3; ++color) {
      float m[kMomentPlanes], g[kGradientPlanes] = {};
      for (int plane = 0; plane < kMomentPlanes; ++plane)
        m[plane] = blur_column(moments, planes, window, plane, color, x, y);
      sum += static_cast<double>(ssim_from_moments(m[kMuX], m[kMuY], m[kXx], m[kYy], m[kXy]));
      ssim_from_moments_vjp(m[kMuX], m[kMuY], m[kXx], m[kYy], m[kXy], 1.0f, g[0], g[1], g[2]);
      for (int plane = 0; plane < kGradientPlanes; ++plane)
        gradients[planes.at(plane, color, x, y)] = g[plane];
    }
    return sum;
  }
};

// The same window, transposed: along y. Element i = (plane, colour, pixel).
struct BlurGradientColumns {
  SsimWindow window;
  PlaneStack planes;
  const float* gradients;
  float* out;

  GLINT_HD void operator()(std::size_t i) const {
    const int stack = static_cast<int>(i / planes.size());
    const int pixel = static_cast<int>(i % planes.size());
    out[i] = blur_column(
        gradients, planes, window, stack / 3, stack % 3, pixel % planes.width, pixel / planes.width
    );
  }
};

struct PhotometricSums {
  double l1 = 0, mse = 0;
  GLINT_HD PhotometricSums& operator+=(const PhotometricSums& o) {
    l1 += o.l1;
    mse += o.mse;
    return *this;
  }
};
// Along x, and to the pixels: dL/dx = F(g_mu) + 2 x F(g_xx) + y F(g_xy), beside L1.
struct PhotometricAt {
  ImageView rendered, target;
  SsimWindow window;
  PlaneStack planes;
  const float* gradients;  // blurred along y
  float l1_scale, ssim_scale;
  ImageRef dL_drendered;

  GLINT_HD PhotometricSums operator()(int x, int y) const {
    PhotometricSums sums;
    for (int color = 0; color < 3; ++color) {
      const float a = rendered.at(x, y, color), b = target.at(x, y, color);
      const float ssim =
          row(0, color, x, y) + 2 * a * row(1, color, x, y) + b * row(2, color, x, y);
      dL_drendered.at(x, y, color) += l1_scale * sign_of(a - b) + ssim_scale * ssim;
      const float clamped = min_of(max_of(a, 0.0f), 1.0f) - b;
      sums.l1 += static_cast<double>(abs_of(a - b));
      sums.mse += static_cast<double>(clamped * clamped);
    }
    return sums;
  }

 private:
  GLINT_HD float row(int plane, int color, int x, int y) const {
    float sum = 0;
    for (int k = 0; k < kSsimTaps; ++k) {
      const int at = x + k - kSsimRadius;
      if (at < 0 || at >= planes.width) continue;
      sum = fma_of(window.weights[k], gradients[planes.at(plane, color, at, y)], sum);
    }
    return sum;
  }
};

using PhotometricKernels = KernelList<BlurMomentRows, BlurGradientColumns, SsimAt, PhotometricAt>;

}  // namespace glint
