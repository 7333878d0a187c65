// SPDX-License-Identifier: MIT
#include <cmath>

#include "glint/scene/image_files.h"

namespace glint {

float srgb_encode(float linear) {
  if (!(linear > 0)) return 0;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

float srgb_decode(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

}  // namespace glint
