// SPDX-License-Identifier: MIT
#include "reports/mesh/mesh_eval.h"

#include "metrics/mesh/mesh_scores.h"
#include "metrics/tools/mesh_inputs.h"

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

struct Layer {
  std::string prefix;
  fs::path mesh, truth;
};

std::vector<Layer> layers_of(const RunSpec& spec) {
  const fs::path first = spec.folder / "mesh.ply";
  const fs::path behind = spec.folder / "mesh_transmission.ply";
  return {
      {"", first, spec.dataset_folder / "gt" / "mesh.ply"},
      {kBehindMesh,
       fs::exists(behind) ? behind : first,
       spec.dataset_folder / "gt" / "mesh_behind.ply"}};
}

}  // namespace

std::map<std::string, double> score_meshes(
    const RunSpec& spec, const Scene& scene, const MeshProtocol& protocol, Json& recipe
) {
  const std::vector<Camera> cameras = train_cameras(scene);
  std::map<std::string, double> values;
  recipe["protocol"] = config_to_json(protocol);
  for (const Layer& layer : layers_of(spec)) {
    if (!fs::exists(layer.mesh) || !fs::exists(layer.truth)) continue;
    Json done = Json::object();
    const Surface mesh =
        prepared(layer.mesh, ExitCode::kBadPrediction, cameras, protocol, done["prediction"]);
    const Surface truth =
        prepared(layer.truth, ExitCode::kBadReference, cameras, protocol, done["reference"]);
    for (const auto distance :
         {SurfaceDistance::kPointToTriangle, SurfaceDistance::kPointToPoint}) {
      MeshProtocol each = protocol;
      each.distance = distance;
      for (const auto& [id, value] : mesh_values(mesh_scores(mesh, truth, each), each))
        values[layer.prefix + id] = value;
    }
    recipe[layer.prefix + "mesh"] = done;
  }
  return values;
}

}  // namespace glint
