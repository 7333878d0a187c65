// SPDX-License-Identifier: MIT
// Scores of a run's meshes against the dataset's.
#pragma once

#include <map>
#include <string>

#include "glint/core/service.h"
#include "glint/scene/scene.h"
#include "metrics/mesh/mesh_protocol.h"
#include "reports/run/records/run_folder.h"

namespace glint {

// Both distances, to triangles and to samples. `recipe` gets the protocol and what was done to
// either mesh, to stand beside the values. Empty: no mesh (or the mesh stage ended with a note), or
// no true one. Errors: kBadPrediction and kBadReference for damaged meshes.
using MeshValues = std::map<std::string, double>;  // by metric id
inline constinit Service<
    MeshValues(const RunSpec& spec, const Scene& scene, const MeshProtocol& protocol, Json& recipe)>
    score_meshes{"scoring meshes", "use the full build"};

}  // namespace glint
