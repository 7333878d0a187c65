// SPDX-License-Identifier: MIT
// Loops of glint/train/exposure.h. A view's gain and offset stay where they run, so that no step
// has to be told whether SSIM lets them count.
#pragma once

#include <cstdint>

#include "glint/core/image.h"
#include "glint/core/kernel.h"

namespace glint {

// Of one view, and its moments [Kingma15].
struct ViewExposure {
  double log_gain = 0, offset = 0;
  double first[2] = {}, second[2] = {};
  int steps = 0;

  GLINT_HD void adam_step(double dL_dlog_gain, double dL_doffset, double rate) {
    constexpr double kBeta1 = 0.9, kBeta2 = 0.99, kEpsilon = 1e-8;
    ++steps;
    const double gradients[2] = {dL_dlog_gain, dL_doffset};
    double* parameters[2] = {&log_gain, &offset};
    const auto t = static_cast<double>(steps);
    for (int i = 0; i < 2; ++i) {
      first[i] += (1 - kBeta1) * (gradients[i] - first[i]);
      second[i] += (1 - kBeta2) * (gradients[i] * gradients[i] - second[i]);
      const double m = first[i] / (1 - pow(kBeta1, t));
      const double v = second[i] / (1 - pow(kBeta2, t));
      *parameters[i] -= rate * m / (sqrt_of(v) + kEpsilon);
    }
  }
};

// What a step takes a view's exposure for: nothing where it does not count.
struct AppliedExposure {
  float gain, offset;
  std::uint32_t counts;  // 1 or 0
};
struct ApplyExposure {
  const ViewExposure* exposure;
  const double* ssim_sum;    // over values
  double num_values, limit;  // of 1 - SSIM, below which it counts
  AppliedExposure* applied;
  GLINT_HD void operator()(std::size_t) const {
    const bool counts = 1.0 - *ssim_sum / num_values < limit;
    *applied = {1, 0, 0};
    if (counts)
      *applied = {
          static_cast<float>(exp_fast(exposure->log_gain)),
          static_cast<float>(exposure->offset),
          1};
  }
};

// gain I + offset; element i: a value.
struct Expose {
  const float* rendered;
  const AppliedExposure* applied;
  float* exposed;
  GLINT_HD void operator()(std::size_t i) const {
    exposed[i] = applied->gain * rendered[i] + applied->offset;
  }
};

struct ExposureGradient {
  double gain = 0, offset = 0;
  GLINT_HD ExposureGradient& operator+=(const ExposureGradient& o) {
    gain += o.gain;
    offset += o.offset;
    return *this;
  }
};
struct ExposeVjp {
  ImageView rendered, dL_dexposed;  // [H][W][3]
  const AppliedExposure* applied;
  ImageRef dL_drendered;  // added to
  GLINT_HD ExposureGradient operator()(int x, int y) const {
    ExposureGradient sum;
    for (int c = 0; c < 3; ++c) {
      const float g = dL_dexposed.at(x, y, c);
      dL_drendered.at(x, y, c) += applied->gain * g;
      sum.gain += static_cast<double>(g * rendered.at(x, y, c));
      sum.offset += static_cast<double>(g);
    }
    return sum;
  }
};
struct StepExposure {
  const AppliedExposure* applied;
  const ExposureGradient* gradient;
  double rate;
  ViewExposure* exposure;
  const std::uint32_t* is_void;  // void_steps.h; null: no
  GLINT_HD void operator()(std::size_t) const {
    if (applied->counts == 0 || (is_void != nullptr && *is_void != 0)) return;
    exposure->adam_step(
        static_cast<double>(applied->gain) * gradient->gain, gradient->offset, rate
    );
  }
};

using ExposureKernels = KernelList<ApplyExposure, Expose, ExposeVjp, StepExposure>;

}  // namespace glint
