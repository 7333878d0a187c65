// SPDX-License-Identifier: MIT
#include "reports/bench/mesh_stage.h"

#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"

namespace glint {
namespace {

fs::path train_folder(const fs::path& run, const View& view) {
  return run / "renders_train" / view_folder(run, view.name).filename();
}

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
  const fs::path folder = train_folder(run, view);
  return with_exit_code(ExitCode::kBadPrediction, [&] {
    return FusionView{
        read_image(folder / map.row().file, 1),
        read_image(folder / MapId("rgb").row().picture, 3),
        view.camera};
  });
}

bool has_map(const fs::path& run, const Scene& scene, MapId map) {
  return fs::exists(train_folder(run, scene.train.front()) / map.row().file);
}

// Depth of what is seen through the glass; the first surface where there is none (t of at most a
// half). Empty: the method does not look behind glass.
Image depth_through_glass(const MapSet& output) {
  const Image &behind = output["behind_depth"], &transparency = output["transparency"];
  if (behind.empty() || transparency.empty()) return {};
  Image depth = output["depth"];
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    if (transparency.data()[i] > 0.5f) depth.data()[i] = behind.data()[i];
  return depth;
}

}  // namespace

fs::path mesh_of(const fs::path& run, const MeshLayer& layer) {
  const fs::path path = run / layer.mesh;
  return fs::exists(path) ? path : run / kMeshLayers[0].mesh;
}

void render_train_stage(const RunSpec& spec, const Scene& scene, Method& method) {
  Progress progress("render training views", scene.train.size());
  for (const View& view : scene.train) {
    throw_if_interrupted();
    const MapSet output = method.render(view.camera);
    synchronize();
    const fs::path folder = train_folder(spec.folder, view);
    const auto write = [&](MapId id, const Image& map) {
      if (!map.empty()) write_exr(folder / id.row().file, map);
    };
    write_png(folder / MapId("rgb").row().picture, output["rgb"]);
    write("depth", output["depth"]);
    write("behind_depth", depth_through_glass(output));
    progress.advance();
  }
}

Json fuse_stage(const RunSpec& spec, const Scene& scene, TsdfOptions options) {
  set_bounds(options, scene);
  Json result = {{"options", config_to_json(options)}, {"views", "training"}};
  result["meshes"] = Json::object();
  for (const MeshLayer& layer : kMeshLayers) {
    std::error_code code;
    fs::remove(spec.folder / layer.mesh, code);
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

Json mesh_stage(
    const RunSpec& spec,
    const Scene& scene,
    Method& method,
    const TsdfOptions& options,
    bool keep_renders
) {
  std::error_code code;
  fs::remove_all(spec.folder / "renders_train", code);
  render_train_stage(spec, scene, method);
  const Json result = fuse_stage(spec, scene, options);
  if (!keep_renders) fs::remove_all(spec.folder / "renders_train", code);
  return result;
}

}  // namespace glint
