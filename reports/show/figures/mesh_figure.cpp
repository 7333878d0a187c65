// SPDX-License-Identifier: MIT
#include "reports/show/figures/mesh_figure.h"

#include <algorithm>
#include <map>
#include <optional>

#include "datasets/released_truth.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "glint/scene/mesh_files.h"
#include "metrics/mesh/clean.h"
#include "metrics/mesh/cull.h"
#include "reports/run/bench/mesh_stage.h"
#include "reports/show/figures/figure_methods.h"
#include "reports/show/figures/mesh_render.h"

namespace glint {

namespace {

struct MeshKind {
  MeshLayer layer;
  const char* title;
  const char* error_title;
};
constexpr MeshKind kKinds[] = {
    {kMeshLayers[0], "mesh", "error"}, {kMeshLayers[1], "mesh behind", "behind, error"}};

// With which the runs were scored: their metrics.json say so; of several the first.
MeshProtocol protocol_of(const FigureScene& scene) {
  for (const auto& [method, folder] : scene.runs) {
    const fs::path path = folder / "metrics.json";
    try {
      if (!is_there(path)) continue;
      const Json json = read_json_object(path, ExitCode::kBadPrediction);
      if (!json.contains("meshes")) continue;
      MeshProtocol protocol;
      config_from_json(protocol, json["meshes"].value("protocol", Json::object()), path.string());
      return protocol;
    } catch (const std::exception& error) {  // another run's may be whole
      log::warn(fmt::format("figures: {}; score the run again", error.what()));
    }
  }
  return {};
}

constexpr int kFiner = 2;  // rays along a side of a pixel of the shaded picture

struct SeenMesh {
  Image shaded;
  MeshRender whole, scored;
  TriangleMesh kept;  // by the protocol; of the truth only: those of all runs would fill the memory
};

class MeshPainter {
 public:
  explicit MeshPainter(const FigureScene& scene)
      : scene_(scene), protocol_(protocol_of(scene)), camera_(scene.camera) {
    const int height = std::max(1, camera_.height * kMaxPanelWidth / camera_.width);
    camera_ = resized(camera_, {kMaxPanelWidth, height});
  }

  // Null: no such file, or a damaged one (a warning). The same file is read once.
  const SeenMesh* see(const fs::path& path, bool is_truth) {
    const auto [it, added] = seen_.try_emplace(path);
    if (added) it->second = look_at(path);
    if (it->second && !is_truth) it->second->kept = {};
    return it->second ? &*it->second : nullptr;
  }

  // Empty without a true surface.
  Image errors(const SeenMesh& mesh, const SeenMesh* truth) const {
    if (truth == nullptr || truth->kept.faces.empty()) return {};
    return distance_picture(distance_map(mesh.whole, mesh.scored, truth->kept, camera_));
  }

 private:
  std::optional<SeenMesh> look_at(const fs::path& path) const {
    try {
      if (!is_there(path)) return std::nullopt;
      const TriangleMesh mesh = clean_mesh(read_mesh(path, NonFinite::kKeep)).mesh;
      SeenMesh seen{shade(mesh), render_mesh(mesh, camera_), {}, kept(mesh)};
      seen.scored = render_mesh(seen.kept, camera_);
      return seen;
    } catch (const Error& error) {
      log::warn(fmt::format("figures: shown as missing: {}", error.what()));
      return std::nullopt;
    }
  }

  TriangleMesh kept(const TriangleMesh& mesh) const {
    if (protocol_.cull == MeshCulling::kNone) return mesh;
    const double tolerance = protocol_.cull_tolerance_m, edge = protocol_.cull_max_edge_m;
    return cull_unseen(mesh, scene_.train_cameras, tolerance, edge).mesh;
  }

  Image shade(const TriangleMesh& mesh) const {
    const ImageSize size = camera_.size();
    const Camera finer = resized(camera_, {kFiner * size.width, kFiner * size.height});
    return resize_image(shaded_picture(render_mesh(mesh, finer)), size);
  }

  const FigureScene& scene_;
  MeshProtocol protocol_;
  Camera camera_;
  std::map<fs::path, std::optional<SeenMesh>> seen_;
};

bool any_has(const FigureScene& scene, const PictureMethods& methods, const char* mesh) {
  return std::any_of(methods.begin(), methods.end(), [&](const std::string& method) {
    const auto run = scene.runs.find(method);
    return run != scene.runs.end() && or_warn([&] { return is_there(run->second / mesh); });
  });
}

void add_rows(
    PictureGrid& grid,
    const FigureScene& scene,
    const PictureMethods& methods,
    const MeshKind& kind,
    MeshPainter& painter
) {
  const SeenMesh* truth = painter.see(true_mesh(scene.data, kind.layer.truth), true);
  PanelRow shaded, errors;
  const auto add = [&](const SeenMesh* mesh) {
    shaded.push_back(mesh != nullptr ? mesh->shaded : Image());
    errors.push_back(mesh != nullptr ? painter.errors(*mesh, truth) : Image());
  };
  add(truth);
  for (const std::string& method : methods) {
    const auto run = scene.runs.find(method);
    add(run != scene.runs.end() ? painter.see(mesh_of(run->second, kind.layer), false) : nullptr);
  }
  grid.row_titles.push_back(fmt::format("{}\n{}", scene.name, kind.title));
  grid.rows.push_back(std::move(shaded));
  if (truth == nullptr) return;
  grid.row_titles.push_back(fmt::format("{}\n{}", scene.name, kind.error_title));
  grid.rows.push_back(std::move(errors));
}

std::vector<LegendLine> mesh_legend() {
  const std::string high = fmt::format("{:g} cm and more", 100 * mesh_error_high());
  return {
      {"distance to the true surface: 0", LegendBar::kError, high},
      {"not scored: no training camera sees it:", LegendBar::kHatch, ""},
      {"no surface:", LegendBar::kGrey, ""}};
}

}  // namespace

PictureGrid meshes_figure(const std::vector<FigureScene>& scenes) {
  PictureGrid grid;
  PictureMethods methods;
  for (const FigureScene& scene : scenes)
    for (const auto& [method, folder] : scene.runs) methods.insert(method);
  for (const FigureScene& scene : scenes) {
    MeshPainter painter(scene);
    for (const MeshKind& kind : kKinds)
      if (any_has(scene, methods, kind.layer.mesh)) add_rows(grid, scene, methods, kind, painter);
  }
  if (grid.rows.empty()) return grid;
  grid.titles.emplace_back("truth");
  for (const std::string& method : methods) grid.titles.push_back(method_title(method));
  grid.legend = {views_line(scenes)};
  for (LegendLine& line : mesh_legend()) grid.legend.push_back(std::move(line));
  return grid;
}

}  // namespace glint
