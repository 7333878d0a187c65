// SPDX-License-Identifier: MIT
#pragma once

namespace glint::gpu {

// Throws Error (kEnvironment). Apart from device_exec.cuh, since nvcc cannot compile fmt's checked
// format strings.
[[noreturn]] void throw_cuda_error(const char* what, const char* reason);

}  // namespace glint::gpu
