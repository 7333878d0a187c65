// SPDX-License-Identifier: MIT
// Scores of a run's meshes against the dataset's.
#pragma once

#include <map>
#include <string>

#include "glint/scene/scene.h"
#include "metrics/mesh/mesh_protocol.h"
#include "reports/records/run_folder.h"

namespace glint {

// Both distances, to triangles and to samples. `recipe` gets the protocol and what was done to
// either mesh, to stand beside the values. Empty: no mesh, or no true one. Errors: kBadPrediction
// and kBadReference for damaged meshes.
std::map<std::string, double> score_meshes(
    const RunSpec& spec, const Scene& scene, const MeshProtocol& protocol, Json& recipe
);

}  // namespace glint
