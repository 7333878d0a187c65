// SPDX-License-Identifier: MIT
#include "glint/core/error.h"
#include "glint/cuda/backend.h"

namespace glint::gpu {

const CudaDevice& cuda_device() {
  static const CudaDevice none{false, "this program was built without a CUDA compiler", {}, {}};
  return none;
}
void use_cuda() { throw Error(ExitCode::kEnvironment, cuda_device().why_not); }
double measure_copy_bandwidth(std::size_t) {
  throw Error(ExitCode::kEnvironment, cuda_device().why_not);
}

}  // namespace glint::gpu
