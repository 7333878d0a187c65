// SPDX-License-Identifier: MIT
// The maps of the surfaces along a ray by their number. Layer 1 is the first one; the others lie
// behind a pane or, where they appear to stand, in a mirror.
#pragma once

#include "glint/scene/maps.h"

namespace glint {

inline constexpr int kMaxLayers = 4;  // that are told apart

// Of layer 1 first.
inline constexpr MapId kLayerDepth[kMaxLayers] = {
    "depth", "layer_2_depth", "layer_3_depth", "layer_4_depth"};
inline constexpr MapId kLayerNormal[kMaxLayers] = {
    "normal", "layer_2_normal", "layer_3_normal", "layer_4_normal"};
inline constexpr MapId kLayerGlass[kMaxLayers] = {
    "glass", "layer_2_glass", "layer_3_glass", "layer_4_glass"};
inline constexpr MapId kLayerMirror[kMaxLayers] = {
    "layer_1_mirror", "layer_2_mirror", "layer_3_mirror", "layer_4_mirror"};
inline constexpr MapId kLayerTransparency[kMaxLayers] = {
    "transparency", "layer_2_transparency", "layer_3_transparency", "layer_4_transparency"};

// Of the second surface and further ones, and of what is a mirror.
inline bool is_layer_map(const MapRow& row) { return row.id.starts_with("layer_"); }
// Of radiance by what its path met.
inline bool is_path_map(const MapRow& row) { return row.id.starts_with("path_"); }

}  // namespace glint
