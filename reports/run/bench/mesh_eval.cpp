// SPDX-License-Identifier: MIT
#include "reports/run/bench/mesh_eval.h"

#include "datasets/released_truth.h"
#include "glint/core/presence.h"
#include "metrics/mesh/mesh_scores.h"
#include "metrics/tools/mesh_inputs.h"
#include "reports/run/bench/mesh_stage.h"
#include "reports/run/records/stage_files.h"

namespace glint {
namespace {

std::vector<Camera> train_cameras(const Scene& scene) {
  std::vector<Camera> cameras;
  for (const View& view : scene.train) cameras.push_back(view.camera);
  return cameras;
}

// Read, cleaned and culled; `recipe` gets what was done.
Surface prepared(
    const fs::path& path,
    ExitCode code,
    const std::vector<Camera>& cameras,
    const MeshProtocol& protocol,
    Json& recipe
) {
  SurfaceInput input = with_exit_code(code, [&] {
    SurfaceInput read = read_surface(path);
    if (protocol.cull == MeshCulling::kCameras) cull_surface(read, cameras, protocol);
    return read;
  });
  recipe = {{"file", path.filename().string()}};
  if (input.cleaning) recipe["clean"] = config_to_json(*input.cleaning);
  if (input.culling) recipe["cull"] = config_to_json(*input.culling);
  return std::move(input.surface);
}

// Of earlier versions, a mesh may lie beside a note that says there is none.
bool ended_without_mesh(const fs::path& run) {
  const auto done = read_stage(run, Stage::kMesh);
  return done && !done->note.empty();
}

MeshValues score_run_meshes(
    const RunSpec& spec, const Scene& scene, const MeshProtocol& protocol, Json& recipe
) {
  if (ended_without_mesh(spec.folder)) return {};
  const std::vector<Camera> cameras = train_cameras(scene);
  std::map<std::string, double> values;
  recipe["protocol"] = config_to_json(protocol);
  for (const MeshLayer& layer : kMeshLayers) {
    const fs::path predicted = mesh_of(spec.folder, layer);
    const fs::path true_file = true_mesh(spec.dataset_folder, layer.truth);
    if (!is_there(predicted) || !is_there(true_file)) continue;
    Json done = Json::object();
    const Surface mesh =
        prepared(predicted, ExitCode::kBadPrediction, cameras, protocol, done["prediction"]);
    const Surface truth =
        prepared(true_file, ExitCode::kBadReference, cameras, protocol, done["reference"]);
    for (const auto distance :
         {SurfaceDistance::kPointToTriangle, SurfaceDistance::kPointToPoint}) {
      MeshProtocol each = protocol;
      each.distance = distance;
      for (const auto& [id, value] : mesh_values(mesh_scores(mesh, truth, each), each))
        values[layer.prefix + id] = value;
    }
    recipe[std::string(layer.prefix) + "mesh"] = done;
  }
  return values;
}

}  // namespace

GLINT_PROVIDE(score_meshes, score_run_meshes)

}  // namespace glint
