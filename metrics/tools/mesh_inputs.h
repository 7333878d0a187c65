// SPDX-License-Identifier: MIT
// The surfaces that glint-mesh compares, as files give them.
#pragma once

#include <optional>
#include <vector>

#include "glint/core/files.h"
#include "glint/scene/camera.h"
#include "glint/scene/mesh_files.h"
#include "metrics/mesh/clean.h"
#include "metrics/mesh/cull.h"
#include "metrics/mesh/mesh_protocol.h"
#include "metrics/mesh/samples.h"

namespace glint {

struct SurfaceInput {
  fs::path path;
  Surface surface;
  std::optional<CleanReport> cleaning;  // of a mesh
  std::optional<CullRecipe> culling;    // where it was culled
};

// What read_surface() makes of the content of a file; `path` stands in messages.
SurfaceInput surface_of_mesh(const fs::path& path, const TriangleMesh& mesh);
SurfaceInput surface_of_points(const fs::path& path, SurfacePoints points);

// A mesh (mesh_files.h), which is cleaned, or a PLY file whose header has no element "face": a
// point cloud. Normals of points are made unit; a zero one drops them all. Errors (kBadReference):
// another extension, mesh_files.h's, no faces before or after cleaning, no points.
SurfaceInput read_surface(const fs::path& path);

const std::vector<Vec3f>& corners_of(const SurfaceInput& input);

// Of a glTF, where z was up. Other files are as they are.
void turn_gltf(SurfaceInput& input, GltfUp up);

// What looks like another unit or axis (mesh_frames.h), both as turned by `up`.
std::vector<std::string> frame_doubts(
    const SurfaceInput& prediction, const SurfaceInput& reference, GltfUp up
);

// `path`, or, for a folder, the file in it, or a model of its name (mesh_files.h). Errors
// (kBadReference): nothing there.
fs::path surface_path(const fs::path& path, const fs::path& file_in_folder);

// Of the training views. Errors (kBadReference): load_scene()'s, no training view.
std::vector<Camera> training_cameras(const fs::path& dataset);

// Replaces the mesh by what the cameras see of it. Errors (kBadReference): a point cloud, nothing
// left.
void cull_surface(
    SurfaceInput& input, const std::vector<Camera>& cameras, const MeshProtocol& protocol
);

}  // namespace glint
