// SPDX-License-Identifier: MIT
// A mesh for the page's 3D view.
#pragma once

#include <cstddef>

#include "glint/core/config.h"
#include "glint/scene/ply.h"

namespace glint {

// Of a mesh on the page; more are merged away. A single file holds every mesh of the profile.
inline constexpr std::size_t kPageFaces = 300'000, kSingleFileFaces = 30'000;

// Vertices of one cell of a cubic grid become their mean; faces that lose a corner go. `cell` in
// metres, above 0.
TriangleMesh merge_vertices(const TriangleMesh& mesh, float cell);

// Merged on ever coarser grids until there are at most `max_faces`; a smaller mesh stays as it is.
TriangleMesh with_few_faces(const TriangleMesh& mesh, std::size_t max_faces);

// {"vertices", "faces", "low", "high", "position", "index", "color"}: positions as 16-bit steps
// from low to high (low bytes, then high bytes), indices as 32 bits, colours as 8 bits or null;
// packed.
Json mesh_json(const TriangleMesh& mesh);

}  // namespace glint
