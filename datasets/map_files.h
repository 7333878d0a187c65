// SPDX-License-Identifier: MIT
// Maps as files of datasets: written so that read_prior() and read_true_map() give them back, and
// the check of what was read.
#pragma once

#include "glint/core/files.h"
#include "glint/scene/maps.h"

namespace glint {

// Value in [0, 1] spread over three 8-bit channels: R + G / 256 + B / 65536, channels in [0, 1].
Image encode_depth(ImageView depth);
// Unit or zero normals as (n + 1) / 2.
Image encode_normal(ImageView normal);

// Errors (kBadReference): a value that is not finite; its pixel is named.
void check_finite(const fs::path& path, const Image& map);

// diffrens/: 8-bit PNG; depth by encode_depth(), normals by encode_normal().
void write_prior(const fs::path& path, MapKind kind, const Image& map);
// gt/: EXR floats, masks as PNG.
void write_true_map(const fs::path& path, MapKind kind, const Image& map);

// Planar depth in metres as 16-bit grey PNG in millimetres, the nearest, 0: nothing. What lies
// beyond kFarthestMillimetres becomes 0. Returns how many pixels did.
inline constexpr float kFarthestMillimetres = 65535;
std::size_t write_depth_millimetres(const fs::path& path, ImageView depth);

}  // namespace glint
