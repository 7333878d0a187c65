// SPDX-License-Identifier: MIT
#include "glint/core/error.h"
#include "glint/cuda/backend.h"
#include "glint/cuda/kernel_events.h"

namespace glint::gpu {

std::unique_ptr<KernelTrace> trace_by_events() {
  throw Error(ExitCode::kEnvironment, cuda_device().why_not);
}

}  // namespace glint::gpu
