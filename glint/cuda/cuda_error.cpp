// SPDX-License-Identifier: MIT
#include "glint/cuda/cuda_error.h"

#include <fmt/format.h>

#include "glint/core/error.h"

namespace glint::gpu {

void throw_cuda_error(const char* what, const char* reason) {
  throw Error(ExitCode::kEnvironment, fmt::format("CUDA: {} failed: {}", what, reason));
}

void throw_no_room(
    const char* device, std::size_t asked, std::size_t free, std::size_t total, std::size_t in_use
) {
  const auto mib = [](std::size_t bytes) { return bytes >> 20; };
  throw Error(
      ExitCode::kEnvironment,
      fmt::format(
          "CUDA: no room for {} MiB on {}: {} of {} MiB are free, {} MiB are in use here; fewer "
          "surfels (max_surfels), smaller images, or a larger card",
          mib(asked),
          device,
          mib(free),
          mib(total),
          mib(in_use)
      )
  );
}

}  // namespace glint::gpu
