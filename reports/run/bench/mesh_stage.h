// SPDX-License-Identifier: MIT
// The mesh stage: a trained method renders the depth of its training views into renders_train/,
// which are fused into mesh.ply (the first surface, glass included) and, for methods that see
// through glass, mesh_transmission.ply (what lies behind it).
#pragma once

#include "datasets/released_truth.h"
#include "glint/core/service.h"
#include "metrics/fusion/tsdf.h"
#include "metrics/mesh/mesh_protocol.h"
#include "reports/run/records/run_folder.h"

namespace glint {

// A surface that becomes a mesh and is scored.
struct MeshLayer {
  MapId map;           // in renders_train/<view>/
  const char* mesh;    // in a run folder
  const char* truth;   // in a dataset folder
  const char* prefix;  // of its metrics' ids
};
inline constexpr MeshLayer kMeshLayers[] = {
    {"depth", "mesh.ply", kTrueMesh, ""},
    {"behind_depth", "mesh_transmission.ply", "gt/mesh_behind.ply", kBehindMesh}};

// The run's mesh of that layer, or where it would be. A method that does not look behind glass, as
// its renders say, has its mesh.ply there: a single layer may lie behind the glass.
fs::path mesh_of(const fs::path& run, const MeshLayer& layer);

// Depth of what is seen through the glass; the first surface where there is none (t of at most a
// half). Empty: the method does not look behind glass.
Image depth_through_glass(const MapSet& rendered);

// Where a training view is rendered to.
fs::path train_view_folder(const fs::path& run, const View& view);

// rgb.png, depth.exr and, of methods that look behind glass, behind_depth.exr (of the first surface
// where t is at most a half) of every training view.
void render_train_stage(const RunSpec& spec, const Scene& scene, Method& method);

// Fuses renders_train/; bounds that are not set are the scene's, grown by a tenth. Writes the
// meshes and mesh.json: options, what was fused, per mesh. Errors: kBadPrediction (no
// renders_train/, a damaged map), those of fuse_depth.
inline constinit Service<Json(const RunSpec& spec, const Scene& scene, TsdfOptions options)>
    fuse_stage{"meshes", "use the full build"};

// Removes the meshes and mesh.json, as far as they are there.
void remove_meshes(const fs::path& run);

// Both (first asking whether the second can be done), renders_train/ removed again unless
// `keep_renders`, and the stage's key. Where either fails, no mesh is left, not even of the layers
// before. Errors: those of the method and of fuse_stage.
Json mesh_stage(
    const RunSpec& spec,
    const Scene& scene,
    Method& method,
    const TsdfOptions& options,
    bool keep_renders = false
);

// The same, for a cell whose depth may give no mesh and which has its other numbers all the same:
// the stage's note says why it has none. Returns it; empty: made. Errors: kEnvironment alone, which
// is nothing of the cell's.
std::string try_mesh_stage(
    const RunSpec& spec, const Scene& scene, Method& method, const TsdfOptions& options
);

}  // namespace glint
