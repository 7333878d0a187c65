// SPDX-License-Identifier: MIT
// The first CUDA device as the place where ops run. Builds without a CUDA compiler have none.
#pragma once

#include <cstddef>
#include <string>

namespace glint::gpu {

struct CudaDevice {
  bool usable = false;
  std::string why_not;         // one line
  std::string name;            // "NVIDIA H100 80GB HBM3"
  std::string driver;          // highest CUDA version that the driver speaks, "13.0"
  int compute_capability = 0;  // 90: 9.0
  std::size_t memory_bytes = 0;
  bool exclusive = false;  // it is set to serve one process at a time
};

// Looks once; never throws.
const CudaDevice& cuda_device();
// Ops run on it from now on. Errors (kEnvironment): it is not usable.
void use_cuda();
// Bytes a second of a copy inside the device's memory, reads and writes counted; by a copy of
// `bytes`, the median of several. Errors (kEnvironment): the device fails.
double measure_copy_bandwidth(std::size_t bytes);

}  // namespace glint::gpu
