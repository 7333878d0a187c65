// SPDX-License-Identifier: MIT
// Maps of priors: read as stored, brought to the size of the picture and to the conventions used
// inside.
#pragma once

#include "datasets/scene_index.h"

namespace glint {

// As GlassRoom and the official release store them. Normals: (n + 1) / 2 to unit n or zero. Depth:
// grey, or R + G/256 + B/65536.
Image read_prior(const fs::path& path, MapKind kind);

// The view's prior in the axes and the kind of depth of its file, of any size. Of other programs:
// depth is the mean of the channels, normals are n where a file of floats holds negative values,
// and (n + 1) / 2 elsewhere. An albedo from the base colour is made here. Errors (kBadReference):
// unreadable files, values that are not finite.
Image read_stored_prior(const ViewSource& view, const MapRow& row);

// Normals get unit length again. Depth is blended where both neighbours have some, and 0 where most
// of the pixel has none.
Image resize_prior(Image map, MapKind kind, ImageSize size);

// One normal from the stored axes to camera axes x right, y down, z forward.
Vec3d normal_in_cam(Vec3d stored, PriorAxes axes, const Camera& camera);

// Normals to unit camera space, OpenCV axes; depth to larger = farther. Disparity becomes 1 /
// disparity, of at least 1/50 of the largest, so that what is far stays finite; 0 stays "nothing".
void convert_prior(MapKind kind, const PriorReading& reading, const Camera& camera, Image& map);

}  // namespace glint
