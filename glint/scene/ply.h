// SPDX-License-Identifier: MIT
// PLY files, binary and ASCII in, binary little-endian out: surfel clouds in the field order that
// common viewers read, coloured points, triangle meshes. Readers never trust a count: it is checked
// against the file's size before anything is allocated. Errors (kBadReference) name the file and
// the first value that is not finite, missing properties, faces that refer to no vertex, cut-off
// rows.
#pragma once

#include "glint/core/files.h"
#include "glint/core/triangle_mesh.h"
#include "glint/scene/surfels.h"

namespace glint {

// Fields: x y z nx ny nz f_dc_0..2 f_rest_0..44 (all R, all G, all B) opacity scale_0 scale_1
// scale_2 rot_0..3 then extra channels by name, all raw. scale_2 = log(1e-6) so that 3DGS viewers
// accept it. Of a cloud whose sh_rest is empty: no f_rest.
void write_surfel_ply(const fs::path& path, const SurfelCloud& cloud);
// scale_2 may be absent; extra float properties become extra channels.
SurfelCloud read_surfel_ply(const fs::path& path);

void write_point_ply(const fs::path& path, const PointCloud& points);
// Without colours in the file: mid-grey.
PointCloud read_point_ply(const fs::path& path);

// What a reader does with a coordinate that is not finite.
enum class NonFinite {
  kReject,  // an error naming it
  kKeep,    // for readers that drop the vertex's faces themselves
};

void write_mesh_ply(const fs::path& path, const TriangleMesh& mesh);
// Polygons become fans of triangles. Errors (kBadReference): faces that have no list vertex_indices
// (or vertex_index), or refer to vertices that are not there.
TriangleMesh read_mesh_ply(const fs::path& path, NonFinite vertices = NonFinite::kReject);
// Whether the header names an element "face", of any number of rows: a mesh, else points.
bool is_mesh_ply(const fs::path& path);

}  // namespace glint
