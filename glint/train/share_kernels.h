// SPDX-License-Identifier: MIT
// Weights of pixels where the number of pixels that count is itself a sum: it stays where ops run,
// and so does the weight.
#pragma once

#include "glint/core/kernel.h"

namespace glint {

// weight / count, 0 where nothing counts.
template <class T>
struct ShareOf {
  const double* count;
  T weight;
  T* share;
  GLINT_HD void operator()(std::size_t) const {
    *share = *count > 0 ? weight / static_cast<T>(*count) : T(0);
  }
};

// count: one number where ops run.
template <class T>
void share_of(const double* count, T weight, Array<T>& share) {
  share.resize(1);
  run_kernel(1, 1, ShareOf<T>{count, weight, share.on_device()});
}

using ShareKernels = KernelList<ShareOf<float>, ShareOf<double>>;

}  // namespace glint
