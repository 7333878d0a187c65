// SPDX-License-Identifier: MIT
// A scene of ClearPose (Chen et al., ECCV 2022): a video of transparent objects, its poses, and
// depth that has the objects' own surfaces (their meshes rendered over the sensor's depth).
//   metadata.mat              a struct of each frame: intrinsic_matrix 3x3,
//   rotation_translation_matrix
//                             3x4 (camera to world, OpenCV's axes), factor_depth (1000)
//   000000-color.png          the picture
//   000000-depth_true.png     true depth of the first surface, steps of 1 / factor_depth metres
// Not read: the sensor's depth, which is no truth; labels, whose numbers say no material; normals,
// whose axes are not documented.
#include <cmath>

#include "datasets/dataset.h"
#include "datasets/mat_file.h"
#include "datasets/scene_index.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

constexpr const char* kColor = "-color.png";

std::vector<fs::path> pictures_in(const fs::path& folder) {
  std::vector<fs::path> pictures;
  for (const fs::path& file : list_files(folder, {".png"}))
    if (file.filename().string().ends_with(kColor)) pictures.push_back(file);
  return pictures;
}

LoaderMatch match(const fs::path& folder) {
  if (!is_file(folder / "metadata.mat")) return {};
  if (pictures_in(folder).empty()) return {Sureness::kName, "metadata.mat"};
  return {Sureness::kContents, "metadata.mat and pictures 000000-color.png"};
}

// Errors (kBadReference): no such field, another shape, values that are not finite.
const std::vector<double>& matrix(
    const MatValue& frame,
    const char* field,
    std::size_t rows,
    std::size_t columns,
    const std::string& where
) {
  const auto found = frame.fields.find(field);
  const bool good =
      found != frame.fields.end() &&
      found->second.extents == std::vector<std::size_t>{rows, columns} &&
      found->second.values.size() == rows * columns &&
      std::ranges::all_of(found->second.values, [](double v) { return std::isfinite(v); });
  GLINT_CHECK(
      good,
      kBadReference,
      "{}: expected {} x {} finite numbers in '{}'",
      where,
      rows,
      columns,
      field
  );
  return found->second.values;
}

// Some releases call the intrinsics as the README does.
const std::vector<double>& intrinsics(const MatValue& frame, const std::string& where) {
  const char* field =
      frame.fields.contains("camera_intrinsics") ? "camera_intrinsics" : "intrinsic_matrix";
  return matrix(frame, field, 3, 3, where);
}

void read_camera(const MatValue& frame, ViewSource& view) {
  const std::vector<double>& k = intrinsics(frame, view.where);  // by columns
  view.camera.fx = k[0], view.camera.fy = k[4];
  view.camera.cx = k[6], view.camera.cy = k[7];
  const std::vector<double>& m = matrix(frame, "rotation_translation_matrix", 3, 4, view.where);
  view.camera.rotation_cam_from_world = {
      {{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}}};  // its columns as rows
  view.camera.translation_cam_from_world =
      -(view.camera.rotation_cam_from_world * Vec3d{m[9], m[10], m[11]});
  const double factor = matrix(frame, "factor_depth", 1, 1, view.where)[0];
  GLINT_CHECK(factor > 0, kBadReference, "{}: factor_depth is {}", view.where, factor);
  view.depth_scale = 1 / factor;
}

ViewSource make_view(const fs::path& picture, const std::map<std::string, MatValue>& frames) {
  ViewSource view;
  const std::string file = picture.filename().string();
  view.name = file.substr(0, file.size() - std::string_view(kColor).size());
  view.image = picture;
  view.where = fmt::format("{}: {}", (picture.parent_path() / "metadata.mat").string(), view.name);
  const auto frame = frames.find(view.name);
  GLINT_CHECK(
      frame != frames.end(),
      kBadReference,
      "{}: no such frame, but {}",
      view.where,
      picture.string()
  );
  read_camera(frame->second, view);
  if (const fs::path depth = picture.parent_path() / (view.name + "-depth_true.png");
      is_there(depth))
    view.truth["depth"] = depth;
  return view;
}

SceneIndex index_folder(const fs::path& folder, const LoadOptions& options) {
  SceneIndex index;
  index.name = folder_name(folder);
  index.dataset = "clearpose";
  const auto frames = read_mat(folder / "metadata.mat");
  for (const fs::path& picture : pictures_in(folder)) {
    try {
      index.views.push_back(make_view(picture, frames));
    } catch (const Error& error) {
      index.problems.push_back(make_finding("camera-field", picture.string(), error.what()));
    }
  }
  sort_naturally(index.views);
  index.split_rule = split_every(index.views, options.test_every);
  index.spec_hash = hash_of_files(read_file(folder / "metadata.mat"), index.views);
  return index;
}

}  // namespace

GLINT_REGISTER(
    LoaderSpec, indexed_loader("clearpose", match, index_folder, "metadata.mat, 000000-color.png")
)

}  // namespace glint
