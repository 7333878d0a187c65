// SPDX-License-Identifier: MIT
// The surfaces that glint-mesh compares, as files give them.
#pragma once

#include <optional>
#include <vector>

#include "glint/core/files.h"
#include "glint/scene/camera.h"
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

// A PLY file whose header has an element "face" is a mesh, which is cleaned; any other is a point
// cloud. Normals of points are made unit; a zero one drops them all. Errors (kBadReference):
// another extension, ply.h's, no faces before or after cleaning, no points.
SurfaceInput read_surface(const fs::path& path);

// Surfaces of so different a size that one is likely in another unit; empty: they are alike.
std::string unit_doubt(const SurfaceInput& prediction, const SurfaceInput& reference);

// `path`, or, for a folder, the file in it. Errors (kBadReference): nothing there.
fs::path surface_path(const fs::path& path, const fs::path& file_in_folder);

// Of the training views. Errors (kBadReference): load_scene()'s, no training view.
std::vector<Camera> training_cameras(const fs::path& dataset);

// Replaces the mesh by what the cameras see of it. Errors (kBadReference): a point cloud, nothing
// left.
void cull_surface(
    SurfaceInput& input, const std::vector<Camera>& cameras, const MeshProtocol& protocol
);

}  // namespace glint
