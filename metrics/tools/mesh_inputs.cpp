// SPDX-License-Identifier: MIT
#include "metrics/tools/mesh_inputs.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "datasets/dataset.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/ply.h"
#include "metrics/length_units.h"
#include "metrics/reduce.h"

namespace glint {
namespace {

// Cameras alone are wanted: pictures are loaded as small as they may be. A camera's image keeps its
// borders when it is resized, so that what is inside stays inside.
constexpr double kLeastPixels = 4096;

void check_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  GLINT_CHECK(
      extension == ".ply",
      kBadReference,
      "{}: '{}' files are not read; expected a mesh or points as .ply (MeshLab, Blender and Open3D "
      "convert)",
      path.string(),
      extension
  );
}

void read_mesh(SurfaceInput& input) {
  const std::string name = input.path.string();
  const TriangleMesh mesh = read_mesh_ply(input.path, NonFinite::kKeep);
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
  input.surface = std::move(clean.mesh);
  input.cleaning = clean.report;
}

// Unit normals, or none where one has no direction.
std::vector<Vec3f> unit_normals(std::vector<Vec3f> normals) {
  for (Vec3f& normal : normals) {
    const float norm = length(normal);
    if (!(norm > 0)) return {};
    normal = 1 / norm * normal;
  }
  return normals;
}

void read_points(SurfaceInput& input) {
  PointCloud cloud = read_point_ply(input.path);
  GLINT_CHECK(!cloud.positions.empty(), kBadReference, "{}: no points", input.path.string());
  input.surface = SurfacePoints{std::move(cloud.positions), unit_normals(std::move(cloud.normals))};
}

}  // namespace

SurfaceInput read_surface(const fs::path& path) {
  check_extension(path);
  SurfaceInput input;
  input.path = path;
  if (is_mesh_ply(path))
    read_mesh(input);
  else
    read_points(input);
  return input;
}

namespace {

const std::vector<Vec3f>& positions_of(const Surface& surface) {
  const auto* points = std::get_if<SurfacePoints>(&surface);
  return points ? points->positions : std::get<TriangleMesh>(surface).vertices;
}

// The median distance of its corners from their median: stray ones do not count. Corners that are
// not finite are no part of any face.
double extent_of(const Surface& surface) {
  std::vector<double> axes[3], distances;
  for (const Vec3f corner : positions_of(surface))
    if (std::isfinite(corner.x + corner.y + corner.z))
      for (int c = 0; c < 3; ++c) axes[c].push_back(static_cast<double>(corner[c]));
  if (axes[0].empty()) return 0;
  const Vec3d middle{median(axes[0]), median(axes[1]), median(axes[2])};
  for (const Vec3f corner : positions_of(surface))
    if (std::isfinite(corner.x + corner.y + corner.z))
      distances.push_back(length(cast<double>(corner) - middle));
  return median(distances);
}

}  // namespace

std::string unit_doubt(const SurfaceInput& prediction, const SurfaceInput& reference) {
  const double found = extent_of(prediction.surface), expected = extent_of(reference.surface);
  if (!(found > 0 && expected > 0) || !is_odd_length_ratio(found / expected)) return {};
  return fmt::format(
      "{} is {:.3g} times as large as {} (by the median distance from its middle) and is scored as "
      "metres; is it in {}?",
      prediction.path.string(),
      found / expected,
      reference.path.string(),
      likely_unit(found / expected)
  );
}

fs::path surface_path(const fs::path& path, const fs::path& file_in_folder) {
  const fs::path file = is_folder(path) ? path / file_in_folder : path;
  GLINT_CHECK(
      is_there(file),
      kBadReference,
      "{}: no such file; expected a .ply, or a folder with {}",
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
