// SPDX-License-Identifier: MIT
// Times of kernels by the device's own clock.
#pragma once

#include <memory>

#include "glint/core/kernel_trace.h"

namespace glint::gpu {

// An event before and after every launch, read by take(). Not while a graph is captured. Errors
// (kEnvironment): the device fails; this program has no CUDA.
std::unique_ptr<KernelTrace> trace_by_events();

}  // namespace glint::gpu
