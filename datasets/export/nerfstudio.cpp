// SPDX-License-Identifier: MIT
// nerfstudio: images/, transforms.json with split lists, points3D.ply. True depth becomes
// depth_file_path where every view has it. Masks of glass are no mask_path: that one says which
// pixels count, and lies in counted/.
#include <algorithm>

#include "datasets/export/export_files.h"
#include "datasets/side_maps.h"
#include "glint/core/config.h"

namespace glint {
namespace {

Json intrinsics_of(const Camera& camera) {
  return {
      {"w", camera.width},
      {"h", camera.height},
      {"fl_x", camera.fx},
      {"fl_y", camera.fy},
      {"cx", camera.cx},
      {"cy", camera.cy}};
}

fs::path nerfstudio_picture(const ExportView& view) {
  return fs::path("images") / (view.name + ".png");
}

Json frame_of(const ExportView& view, bool with_intrinsics, bool with_depth) {
  const Camera& camera = view.view->camera;
  Json frame = with_intrinsics ? intrinsics_of(camera) : Json::object();
  frame["file_path"] = nerfstudio_picture(view).generic_string();
  frame["transform_matrix"] = opengl_world_from_cam(camera);
  if (!view.view->counted.empty()) frame["mask_path"] = counted_file(view.name).generic_string();
  if (with_depth)
    frame["depth_file_path"] = side_truth_file(MapId("depth").row(), view.name).generic_string();
  return frame;
}

// All or none: nerfstudio refuses depth of some frames.
bool all_have_depth(const ExportInput& input) {
  return std::all_of(input.views.begin(), input.views.end(), [](const ExportView& view) {
    return view.view->truth.has("depth");
  });
}

// Where one list is, nerfstudio wants all three.
void add_split(const ExportInput& input, Json& json) {
  for (const char* key : {"train_filenames", "val_filenames", "test_filenames"})
    json[key] = Json::array();
  for (const ExportView& view : input.views) {
    const std::string path = nerfstudio_picture(view).generic_string();
    if (!view.is_test) json["train_filenames"].push_back(path);
    if (view.is_test) json["val_filenames"].push_back(path);
    if (view.is_test) json["test_filenames"].push_back(path);
  }
}

void write(const ExportInput& input, const fs::path& folder, ExportReport& report) {
  const Json shared = intrinsics_of(input.views.front().view->camera);
  // A field stands for all or in every frame, never both.
  const bool same = std::all_of(input.views.begin(), input.views.end(), [&](const ExportView& v) {
    return intrinsics_of(v.view->camera) == shared;
  });
  Json json = same ? shared : Json::object();
  json["camera_model"] = "OPENCV";
  json["frames"] = Json::array();
  const bool with_depth = all_have_depth(input);
  for (const ExportView& view : input.views)
    json["frames"].push_back(frame_of(view, !same, with_depth));
  add_split(input, json);
  write_pictures(input, folder, nerfstudio_picture, report);
  report.add("images/", fmt::format("{} PNG, 8 bit", input.views.size()));
  report.add(
      "transforms.json",
      fmt::format(
          "{}; train_, val_ and test_filenames{}",
          count_views(input),
          with_depth ? ", depth_file_path" : ""
      )
  );
  if (write_points(input, folder, "points3D.ply", PointNormals::kAsTheyAre, report))
    json["ply_file_path"] = "points3D.ply";
  write_file(folder / "transforms.json", json.dump(1) + "\n");
  report.note(
      "split: the lists of transforms.json, which nerfstudio obeys; val is test. Renders of "
      "`ns-render dataset` keep the names of views"
  );
  report.note(
      "nerfstudio moves and scales poses in training: pictures compare, its depth and meshes only "
      "after undoing dataparser_transforms.json"
  );
}

}  // namespace

GLINT_REGISTER(
    ExporterSpec, {"nerfstudio", "nerfstudio (ns-train), instant-ngp", write, false, true}
)

}  // namespace glint
