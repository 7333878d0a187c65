// SPDX-License-Identifier: MIT
#include "glint/core/srgb.h"
#include "glint/scene/image_files.h"

namespace glint {

float srgb_encode(float linear) { return linear > 0 ? srgb_of_linear(linear) : 0.0f; }

float srgb_decode(float encoded) { return linear_of_srgb(encoded); }

}  // namespace glint
