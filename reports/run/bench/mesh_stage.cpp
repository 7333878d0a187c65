// SPDX-License-Identifier: MIT
#include "reports/run/bench/mesh_stage.h"

#include <algorithm>

#include "glint/core/interrupt.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "metrics/fusion/tsdf_volume.h"
#include "reports/run/bench/run_stage.h"
#include "reports/run/bench/stage_documents.h"
#include "reports/run/records/earlier_run.h"

namespace glint {
namespace {

// Do the renders have what depth_through_glass() goes by?
bool looks_behind_glass(const fs::path& run) {
  const auto has = [](const fs::path& view, MapId map) { return is_there(view / map.row().file); };
  const auto views = list_folders(run / "renders");
  return std::any_of(views.begin(), views.end(), [&](const fs::path& view) {
    return has(view, "behind_depth") && has(view, "transparency");
  });
}

}  // namespace

Image depth_through_glass(const MapSet& rendered) {
  const Image &behind = rendered["behind_depth"], &transparency = rendered["transparency"];
  if (behind.empty() || transparency.empty()) return {};
  Image depth = rendered["depth"];
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    if (transparency.data()[i] > 0.5f) depth.data()[i] = behind.data()[i];
  return depth;
}

fs::path mesh_of(const fs::path& run, const MeshLayer& layer) {
  const fs::path path = run / layer.mesh;
  return is_there(path) || looks_behind_glass(run) ? path : run / kMeshLayers[0].mesh;
}

void remove_meshes(const fs::path& run) {
  std::error_code code;
  for (const std::string& file : stage_outputs(Stage::kMesh)) fs::remove(run / file, code);
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

namespace {

Json mesh_document_of(const RunSpec& spec, const TsdfOptions& options) {
  return mesh_document(spec.method, key_of_stage(spec.folder, Stage::kTrain), options);
}

std::string why_no_mesh(
    const RunSpec& spec, const Scene& scene, Method& method, const TsdfOptions& options
) {
  if (!has_tsdf_volume()) return "no Open3D";
  try {
    mesh_stage(spec, scene, method, options);
    return {};
  } catch (const Error& error) {
    if (error.code() == ExitCode::kEnvironment) throw;  // nothing that another run would lack
    log::warn(fmt::format("{}: no mesh: {}", spec.folder.string(), error.what()));
    return fmt::format("no mesh: {}", error.what());
  }
}

}  // namespace

Json mesh_stage(
    const RunSpec& spec,
    const Scene& scene,
    Method& method,
    const TsdfOptions& options,
    bool keep_renders
) {
  begin_stage(spec.folder, Stage::kMesh);
  fuse_stage.require();
  check_tsdf_options(options);  // before views are rendered
  const fs::path renders = spec.folder / "renders_train";
  const auto drop_renders = [&] {
    if (!keep_renders) remove_renders(renders);
  };
  remove_meshes(spec.folder);
  remove_renders(renders);
  try {
    render_train_stage(spec, scene, method);
    Json result = fuse_stage(spec, scene, options);
    drop_renders();
    end_stage(spec.folder, Stage::kMesh, mesh_document_of(spec, options));
    return result;
  } catch (...) {
    remove_meshes(spec.folder);  // one layer without the other would be scored as both
    drop_renders();
    throw;
  }
}

std::string try_mesh_stage(
    const RunSpec& spec, const Scene& scene, Method& method, const TsdfOptions& options
) {
  begin_stage(spec.folder, Stage::kMesh);
  remove_meshes(spec.folder);
  const std::string why = why_no_mesh(spec, scene, method, options);
  if (!why.empty())
    end_stage(
        spec.folder,
        Stage::kMesh,
        document_without_mesh(mesh_document_of(spec, options), options),
        why
    );
  return why;
}

}  // namespace glint
