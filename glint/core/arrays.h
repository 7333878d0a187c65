// SPDX-License-Identifier: MIT
// Vectors that ops read and write, on whichever device they run.
#pragma once

#include <vector>

#include "glint/core/device.h"

namespace glint {

template <class T>
using Array = std::vector<T, ArrayAllocator<T>>;
using FloatArray = Array<float>;

}  // namespace glint
