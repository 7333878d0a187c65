// SPDX-License-Identifier: MIT
// COLMAP: images/, sparse/0/{cameras,images,points3D}.{bin,txt}, sparse/0/test.txt. 3DGS, 2DGS and
// gsplat hold out every 8th picture in the order of names; where these are not the test views,
// pictures are numbered so that they are, as far as the counts allow.
#include <algorithm>
#include <map>
#include <tuple>

#include "datasets/colmap_model.h"
#include "datasets/export/export_files.h"

namespace glint {
namespace {

constexpr std::size_t kHoldOut = 8;

bool holds_out_test_views(const std::vector<ExportView>& views) {
  for (std::size_t i = 0; i < views.size(); ++i)
    if (views[i].is_test != (i % kHoldOut == 0)) return false;
  return true;
}

// Test views at 0, 8, 16, ..., each kind in its order. Empty: there are too few or too many.
std::vector<ExportView> with_test_views_every_eighth(const std::vector<ExportView>& views) {
  std::vector<ExportView> train, test, all;
  for (const ExportView& view : views) (view.is_test ? test : train).push_back(view);
  if (test.size() != (views.size() + kHoldOut - 1) / kHoldOut) return {};
  for (std::size_t i = 0, from_train = 0; i < views.size(); ++i)
    all.push_back(i % kHoldOut == 0 ? test[i / kHoldOut] : train[from_train++]);
  number_names(all);
  return all;
}

// Views as they are stored, and what becomes of the split.
std::vector<ExportView> ordered_views(const ExportInput& input, ExportReport& report) {
  if (holds_out_test_views(input.views)) {
    report.note(
        "split: every 8th picture in the order of names, which 3DGS, 2DGS (--eval) and gsplat "
        "(test_every 8) hold out, is a test view"
    );
    return input.views;
  }
  if (auto views = with_test_views_every_eighth(input.views); !views.empty()) {
    report.note(
        "split: pictures are numbered so that every 8th, which 3DGS, 2DGS (--eval) and gsplat "
        "(test_every 8) hold out, is a test view; the rest of a name is the view's"
    );
    return views;
  }
  report.note(
      "split: 3DGS, 2DGS (--eval) and gsplat hold out every 8th picture in the order of names, "
      "which is NOT the split of this scene; it stands in sparse/0/test.txt, which 3DGS reads when "
      "its llffhold is 0. --format nerfstudio keeps any split"
  );
  return input.views;
}

fs::path colmap_picture(const ExportView& view) {
  return fs::path("images") / (view.name + ".png");
}

// One camera for all views of the same size and intrinsics.
ColmapModel model_of(const ExportInput& input) {
  ColmapModel model;
  std::map<std::tuple<int, int, double, double, double, double>, std::uint32_t> ids;
  for (const ExportView& view : input.views) {
    const Camera& c = view.view->camera;
    const auto next = static_cast<std::uint32_t>(ids.size() + 1);
    const std::uint32_t id =
        ids.emplace(std::tuple{c.width, c.height, c.fx, c.fy, c.cx, c.cy}, next).first->second;
    model.cameras[id] = {
        kColmapPinhole,
        static_cast<std::uint64_t>(c.width),
        static_cast<std::uint64_t>(c.height),
        {c.fx, c.fy, c.cx, c.cy}};
    model.images.push_back(
        {static_cast<std::uint32_t>(model.images.size() + 1),
         id,
         view.name + ".png",
         quaternion_from_rotation(c.rotation_cam_from_world),
         c.translation_cam_from_world}
    );
  }
  return model;
}

bool is_centered(const ExportView& view) {
  const Camera& c = view.view->camera;
  return c.cx == 0.5 * c.width && c.cy == 0.5 * c.height;
}

void write(ExportInput& input, const fs::path& folder, ExportReport& report) {
  input.views = ordered_views(input, report);
  write_pictures(input, folder, colmap_picture, report);
  const ColmapModel model = model_of(input);
  const PointCloud& points = input.scene.points;
  write_colmap_model(folder / "sparse/0", model, points);
  std::string test;
  for (const ExportView& view : input.views)
    if (view.is_test) test += view.name + ".png\n";
  write_file(folder / "sparse/0/test.txt", test);
  report.add("images/", fmt::format("{} PNG, 8 bit", input.views.size()));
  report.add(
      "sparse/0/",
      fmt::format(
          "{}, {} PINHOLE camera{}, {} points without tracks, each as .bin and .txt; test.txt",
          count_views(input),
          model.cameras.size(),
          model.cameras.size() == 1 ? "" : "s",
          points.positions.size()
      )
  );
  if (!std::all_of(input.views.begin(), input.views.end(), is_centered))
    report.note(
        "principal points are not in the middle: gsplat uses them, 3DGS and 2DGS take the middle"
    );
  if (!points.positions.empty())
    report.note(
        "points have no tracks: gsplat's --depth_loss finds none (its other options do not ask)"
    );
}

}  // namespace

GLINT_REGISTER(ExporterSpec, {"colmap", "3DGS, 2DGS, PGSR, gsplat, nerfstudio's colmap", write})

}  // namespace glint
