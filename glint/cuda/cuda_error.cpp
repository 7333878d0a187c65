// SPDX-License-Identifier: MIT
#include "glint/cuda/cuda_error.h"

#include <fmt/format.h>

#include "glint/core/error.h"

namespace glint::gpu {

void throw_cuda_error(const char* what, const char* reason) {
  throw Error(ExitCode::kEnvironment, fmt::format("CUDA: {} failed: {}", what, reason));
}

}  // namespace glint::gpu
