// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>
#include <string_view>

namespace glint::gpu {

// GLINT_REQUIRE_GPU=1: there has to be a GPU, so that nothing passes for want of one.
inline bool gpu_required() {
  const char* value = std::getenv("GLINT_REQUIRE_GPU");
  return value != nullptr && *value != '\0' && std::string_view(value) != "0";
}

}  // namespace glint::gpu
