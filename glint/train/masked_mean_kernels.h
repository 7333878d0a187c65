// SPDX-License-Identifier: MIT
// Means over masks (masked_mean.h), pixel by pixel.
#pragma once

#include "glint/core/kernel.h"
#include "glint/train/pixel_access.h"
#include "glint/train/pixel_losses.h"

namespace glint {

// What of t is averaged over a mask, and its slope.
template <class T>
struct CrossEntropyOfT {
  T target;
  GLINT_HD T value(T t) const { return binary_cross_entropy(t, target); }
  GLINT_HD void vjp(T t, T dL_dvalue, T& dL_dt) const {
    binary_cross_entropy_vjp(t, target, dL_dvalue, dL_dt);
  }
};
template <class T>
struct EntropyOfT {
  GLINT_HD T value(T t) const { return binary_entropy(t); }
  GLINT_HD void vjp(T t, T dL_dvalue, T& dL_dt) const { binary_entropy_vjp(t, dL_dvalue, dL_dt); }
};
template <class T>
struct ValueOfT {
  GLINT_HD T value(T t) const { return t; }
  GLINT_HD void vjp(T, T dL_dvalue, T& dL_dt) const { dL_dt += dL_dvalue; }
};
// max(0, least - t)^2
template <class T>
struct HingeOfT {
  T least;
  GLINT_HD T value(T t) const { return square(max_of(least - t, T(0))); }
  GLINT_HD void vjp(T t, T dL_dvalue, T& dL_dt) const {
    dL_dt += T(-2) * max_of(least - t, T(0)) * dL_dvalue;
  }
};

// sum m f(t); the gradient is that of *scale times it.
template <class T, class Of>
struct MaskedSumAt {
  BasicImageView<T> t;
  ImageView mask;
  Of of;
  const T* scale;
  BasicImageRef<T> dL_dt;

  GLINT_HD double operator()(int x, int y) const {
    const T m = static_cast<T>(mask.at(x, y)), here = t.at(x, y);
    of.vjp(here, *scale * m, dL_dt.at(x, y));
    return static_cast<double>(m * of.value(here));
  }
};

// Where one of two masks says something.
struct AddMasks {
  const float *a, *b;
  float* sum;
  GLINT_HD void operator()(std::size_t i) const { sum[i] = min_of(a[i] + b[i], 1.0f); }
};

using MaskedMeanKernels = KernelList<
    MaskedSumAt<float, CrossEntropyOfT<float>>,
    MaskedSumAt<float, EntropyOfT<float>>,
    MaskedSumAt<float, ValueOfT<float>>,
    MaskedSumAt<float, HingeOfT<float>>,
    AddMasks>;

}  // namespace glint
