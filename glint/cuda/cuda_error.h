// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace glint::gpu {

// Throws Error (kEnvironment). Apart from device_exec.cuh, since nvcc cannot compile fmt's checked
// format strings.
[[noreturn]] void throw_cuda_error(const char* what, const char* reason);
// The same for a card that is too small: bytes asked for, free, of the card, in use by this program.
[[noreturn]] void throw_no_room(
    const char* device, std::size_t asked, std::size_t free, std::size_t total, std::size_t in_use
);

}  // namespace glint::gpu
