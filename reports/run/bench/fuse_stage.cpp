// SPDX-License-Identifier: MIT
// The part of the mesh stage that needs the library fusion.
#include "glint/core/interrupt.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"
#include "reports/run/bench/mesh_stage.h"

namespace glint {
namespace {

// The scene's bounds are those of its points or cameras; surfaces may lie a little outside.
void set_bounds(TsdfOptions& options, const Scene& scene) {
  if (options.bounded()) return;
  constexpr double kMargin = 0.1;
  const Vec3f low = scene.bounds_min, high = scene.bounds_max;
  const double lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z};
  for (std::size_t i = 0; i < 3; ++i) {
    const double margin = kMargin * (highs[i] - lows[i]);
    options.bounds_min[i] = lows[i] - margin;
    options.bounds_max[i] = highs[i] + margin;
  }
}

FusionView load_view(const fs::path& run, const View& view, MapId map) {
  const fs::path folder = train_view_folder(run, view);
  return with_exit_code(ExitCode::kBadPrediction, [&] {
    return FusionView{
        read_image(folder / map.row().file, 1),
        read_image(folder / MapId("rgb").row().picture, 3),
        view.camera};
  });
}

bool has_map(const fs::path& run, const Scene& scene, MapId map) {
  return is_there(train_view_folder(run, scene.train.front()) / map.row().file);
}

Json fuse_renders(const RunSpec& spec, const Scene& scene, TsdfOptions options) {
  set_bounds(options, scene);
  Json result = {{"options", config_to_json(options)}, {"views", "training"}};
  result["meshes"] = Json::object();
  for (const MeshLayer& layer : kMeshLayers) {
    if (!has_map(spec.folder, scene, layer.map)) continue;
    const auto view = [&](std::size_t i) {
      throw_if_interrupted();
      return load_view(spec.folder, scene.train[i], layer.map);
    };
    TsdfReport report;
    write_mesh_ply(
        spec.folder / layer.mesh, fuse_depth(view, scene.train.size(), options, &report)
    );
    result["meshes"][layer.mesh] = config_to_json(report);
  }
  write_file(spec.folder / "mesh.json", result.dump(2) + "\n");
  return result;
}

}  // namespace

GLINT_PROVIDE(fuse_stage, fuse_renders)

}  // namespace glint
