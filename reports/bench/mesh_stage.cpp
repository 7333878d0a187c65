// SPDX-License-Identifier: MIT
#include "reports/bench/mesh_stage.h"
#include "reports/records/earlier_run.h"

#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

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

fs::path train_view_folder(const fs::path& run, const View& view) {
  return run / "renders_train" / view_folder(run, view.name).filename();
}

void render_train_stage(const RunSpec& spec, const Scene& scene, Method& method) {
  Progress progress("render training views", scene.train.size());
  for (const View& view : scene.train) {
    throw_if_interrupted();
    const MapSet output = method.render_view(view);
    const fs::path folder = train_view_folder(spec.folder, view);
    const auto write = [&](MapId id, const Image& map) {
      if (!map.empty()) write_exr(folder / id.row().file, map);
    };
    write_png(folder / MapId("rgb").row().picture, output["rgb"]);
    write("depth", output["depth"]);
    write("behind_depth", depth_through_glass(output));
    progress.advance();
  }
}

Json mesh_stage(
    const RunSpec& spec,
    const Scene& scene,
    Method& method,
    const TsdfOptions& options,
    bool keep_renders
) {
  fuse_stage.require();
  remove_renders(spec.folder / "renders_train");
  render_train_stage(spec, scene, method);
  const Json result = fuse_stage(spec, scene, options);
  if (!keep_renders) remove_renders(spec.folder / "renders_train");
  return result;
}

}  // namespace glint
