// SPDX-License-Identifier: MIT
// Failures of CUDA, in words that say what to do. Apart from device_exec.cuh, since nvcc cannot
// compile fmt's checked format strings; without CUDA's headers, so that any build can test it.
#pragma once

#include <cstddef>
#include <string>

namespace glint::gpu {

// `error`: a cudaError_t as a number, here and below. One line; empty: nothing to add to CUDA's own
// words.
std::string advice_for(int error);
// After it no call of this process to the device works any more.
bool loses_device(int error);

// Throws Error (kEnvironment): DeviceLost where the device is, OutOfMemory where it is full.
[[noreturn]] void throw_cuda_error(const char* what, int error, const char* reason);
[[noreturn]] void throw_cuda_error(const char* what, const char* reason);
// Throws OutOfMemory: the card is too small, or others fill it. Bytes asked for, free and there in
// all.
[[noreturn]] void throw_out_of_memory(std::size_t needed, std::size_t free, std::size_t total);

// "driver for CUDA 12.2, program for CUDA 13.0" of versions as CUDA counts them, 13000; with what
// to do where the driver is the older one.
std::string driver_text(int driver, int runtime);

}  // namespace glint::gpu
