// SPDX-License-Identifier: MIT
#include "metrics/tools/mesh_inputs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "datasets/dataset.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/mesh_files.h"
#include "metrics/mesh_frames.h"

namespace glint {
namespace {

// Cameras alone are wanted: pictures are loaded as small as they may be. A camera's image keeps its
// borders when it is resized, so that what is inside stays inside.
constexpr double kLeastPixels = 4096;

// Unit normals, or none where one has no direction.
std::vector<Vec3f> unit_normals(std::vector<Vec3f> normals) {
  for (Vec3f& normal : normals) {
    const float norm = length(normal);
    if (!(norm > 0)) return {};
    normal = 1 / norm * normal;
  }
  return normals;
}

}  // namespace

SurfaceInput surface_of_mesh(const fs::path& path, const TriangleMesh& mesh) {
  const std::string name = path.string();
  GLINT_CHECK(
      !mesh.faces.empty(),
      kBadReference,
      "{}: a mesh of {} vertices without faces; extract it again, or leave the element 'face' out "
      "of "
      "the header when its points are meant",
      name,
      mesh.vertices.size()
  );
  CleanMesh clean = clean_mesh(mesh);
  GLINT_CHECK(
      !clean.mesh.faces.empty(),
      kBadReference,
      "{}: none of {} faces can be used: {} are not finite, {} have no area",
      name,
      clean.report.faces_before,
      clean.report.not_finite,
      clean.report.zero_area
  );
  if (clean.report.not_finite > 0)
    log::warn(fmt::format(
        "{}: {} of {} faces have a corner that is not finite, and are dropped",
        name,
        clean.report.not_finite,
        clean.report.faces_before
    ));
  return {path, std::move(clean.mesh), clean.report, {}};
}

SurfaceInput surface_of_points(const fs::path& path, SurfacePoints points) {
  GLINT_CHECK(!points.positions.empty(), kBadReference, "{}: no points", path.string());
  points.normals = unit_normals(std::move(points.normals));
  return {path, std::move(points), {}, {}};
}

SurfaceInput read_surface(const fs::path& path) {
  if (mesh_extension(path) != ".ply" || is_mesh_ply(path))
    return surface_of_mesh(path, read_mesh(path, NonFinite::kKeep));
  PointCloud cloud = read_point_ply(path);
  return surface_of_points(path, {std::move(cloud.positions), std::move(cloud.normals)});
}

const std::vector<Vec3f>& corners_of(const SurfaceInput& input) {
  const auto* points = std::get_if<SurfacePoints>(&input.surface);
  return points ? points->positions : std::get<TriangleMesh>(input.surface).vertices;
}

void turn_gltf(SurfaceInput& input, GltfUp up) {
  if (up == GltfUp::kZ && is_gltf(input.path)) turn_back(std::get<TriangleMesh>(input.surface));
}

std::vector<std::string> frame_doubts(
    const SurfaceInput& prediction, const SurfaceInput& reference, GltfUp up
) {
  const NamedCorners found{prediction.path, corners_of(prediction)},
      expected{reference.path, corners_of(reference)};
  std::vector<std::string> doubts;
  for (std::string doubt :
       {mesh_unit_doubt(found, expected),
        gltf_up_doubt(found, expected, up),
        gltf_up_doubt(expected, found, up)})
    if (!doubt.empty()) doubts.push_back(std::move(doubt));
  return doubts;
}

fs::path surface_path(const fs::path& path, const fs::path& file_in_folder) {
  const fs::path file = is_folder(path) ? mesh_or_model(path / file_in_folder) : path;
  GLINT_CHECK(
      is_there(file),
      kBadReference,
      "{}: no such file; expected a mesh, or a folder with {}",
      file.string(),
      file_in_folder.string()
  );
  return file;
}

std::vector<Camera> training_cameras(const fs::path& dataset) {
  LoadOptions options;
  options.max_pixels = kLeastPixels;
  options.with_truth = options.with_priors = false;
  const Scene scene = load_scene(dataset, options);
  GLINT_CHECK(!scene.train.empty(), kBadReference, "{}: no training view", dataset.string());
  std::vector<Camera> cameras;
  for (const View& view : scene.train) cameras.push_back(view.camera);
  return cameras;
}

void cull_surface(
    SurfaceInput& input, const std::vector<Camera>& cameras, const MeshProtocol& protocol
) {
  const auto* mesh = std::get_if<TriangleMesh>(&input.surface);
  GLINT_CHECK(
      mesh != nullptr,
      kBadReference,
      "{}: points hide nothing and cannot be culled; give meshes, or --cull none",
      input.path.string()
  );
  CulledMesh culled =
      cull_unseen(*mesh, cameras, protocol.cull_tolerance_m, protocol.cull_max_edge_m);
  GLINT_CHECK(
      !culled.mesh.faces.empty(),
      kBadReference,
      "{}: none of {} faces is seen by any of {} cameras; is the mesh in the dataset's frame?",
      input.path.string(),
      culled.recipe.faces_before,
      cameras.size()
  );
  input.surface = std::move(culled.mesh);
  input.culling = culled.recipe;
}

}  // namespace glint
