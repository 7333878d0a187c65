// SPDX-License-Identifier: MIT
// The mesh stage: a trained method renders the depth of its training views into renders_train/,
// which are fused into mesh.ply (the first surface, glass included) and, for methods that see
// through glass, mesh_transmission.ply (what lies behind it).
#pragma once

#include "reports/bench/run_folder.h"
#include "reports/mesh/tsdf.h"

namespace glint {

// The layers of a run that become meshes: map in renders_train/<view>/, mesh file.
struct MeshLayer {
  std::string map, mesh;
};
const std::vector<MeshLayer>& mesh_layers();

// rgb.png, depth.exr and, of methods that look behind glass, behind_depth.exr (of the first surface
// where t is at most a half) of every training view.
void render_train_stage(const RunSpec& spec, const Scene& scene, const Method& method);

// Fuses renders_train/; bounds that are not set are the scene's, grown by a tenth. Writes the
// meshes and mesh.json: options, what was fused, per mesh. Errors: kBadPrediction (no
// renders_train/, a damaged map), those of fuse_depth.
Json fuse_stage(const RunSpec& spec, const Scene& scene, TsdfOptions options);

// Both, and renders_train/ removed again unless `keep_renders`.
Json mesh_stage(
    const RunSpec& spec,
    const Scene& scene,
    const Method& method,
    const TsdfOptions& options,
    bool keep_renders = false
);

}  // namespace glint
