// SPDX-License-Identifier: MIT
// Blender's NeRF exports: train/, test/, transforms_{train,val,test}.json with one camera_angle_x,
// points3d.ply where 3DGS looks for it. One angle says all of the camera: other cameras are an
// error.
#include <cmath>

#include "datasets/export/export_files.h"
#include "glint/core/config.h"
#include "glint/core/error.h"

namespace glint {
namespace {

// What one angle cannot say.
void check_camera(const ExportView& view, const Camera& first) {
  constexpr double kSlack = 1e-6;  // pixels
  const Camera& c = view.view->camera;
  const bool same = c.size() == first.size() && std::abs(c.fx - first.fx) <= kSlack;
  const bool square = std::abs(c.fx - c.fy) <= kSlack;
  const bool centered =
      std::abs(c.cx - 0.5 * c.width) <= kSlack && std::abs(c.cy - 0.5 * c.height) <= kSlack;
  GLINT_CHECK(
      same && square && centered,
      kUsage,
      "view {}: {} x {} pixels, focal lengths ({:.6g}, {:.6g}), principal point ({:.6g}, {:.6g}); "
      "the format blender has one angle for all views: square pixels, principal point in the "
      "middle, the camera of the first view. Take --format colmap or nerfstudio",
      view.view->name,
      c.width,
      c.height,
      c.fx,
      c.fy,
      c.cx,
      c.cy
  );
}

// Without its extension, as in Blender's files.
fs::path blender_file(const ExportView& view) {
  return fs::path(view.is_test ? "test" : "train") / view.name;
}

void write_transforms(const ExportInput& input, bool is_test, const fs::path& path) {
  const Camera& camera = input.views.front().view->camera;
  Json json = {
      {"camera_angle_x", 2 * std::atan(0.5 * camera.width / camera.fx)}, {"frames", Json::array()}};
  for (const ExportView& view : input.views)
    if (view.is_test == is_test)
      json["frames"].push_back(
          {{"file_path", "./" + blender_file(view).generic_string()},
           {"transform_matrix", opengl_world_from_cam(view.view->camera)}}
      );
  write_file(path, json.dump(1) + "\n");
}

void write(const ExportInput& input, const fs::path& folder, ExportReport& report) {
  for (const ExportView& view : input.views) check_camera(view, input.views.front().view->camera);
  write_pictures(
      input, folder, [](const ExportView& view) { return blender_file(view) += ".png"; }, report
  );
  write_transforms(input, false, folder / "transforms_train.json");
  write_transforms(input, true, folder / "transforms_val.json");
  write_transforms(input, true, folder / "transforms_test.json");
  report.add("train/, test/", fmt::format("{} as PNG, 8 bit, no alpha", count_views(input)));
  report.add("transforms_*.json", "train, test, and val, which is test");
  write_points(input, folder, "points3d.ply", PointNormals::kAlways, report);
  report.note("split: the files of transforms, which every reader of the format obeys");
  report.note(
      "readers of this format expect an object near the origin: 3DGS reads points3d.ply, others "
      "start from random points in a small box"
  );
}

}  // namespace

GLINT_REGISTER(
    ExporterSpec, {"blender", "NeRF-synthetic readers: 3DGS, 2DGS, instant-ngp, nerfstudio", write}
)

}  // namespace glint
