// SPDX-License-Identifier: MIT
// EasyVolcap, as EnvGS and GLINT read it (datasets/easyvolcap.cpp): all priors in diffrens/, and
// all ground truth in gt/ as GlassRoom has it.
#include <algorithm>

#include "datasets/export/export_files.h"
#include "datasets/map_files.h"
#include "datasets/opencv_yaml.h"

namespace glint {
namespace {

fs::path frame_of_view(const ExportView& view) { return fs::path(view.name) / "000000.png"; }

void write_maps(const ExportView& view, const fs::path& folder) {
  view.view->priors.for_each([&](const MapRow& row, const Image& map) {
    write_prior(folder / "diffrens" / row.prior / frame_of_view(view), row.kind, map);
  });
  view.view->truth.for_each([&](const MapRow& row, const Image& map) {
    if (!row.truth.empty())
      write_true_map(folder / "gt" / true_map_file(row, view.name), row.kind, map);
  });
}

bool has_maps(const ExportInput& input, MapSet View::*set) {
  return std::any_of(input.views.begin(), input.views.end(), [&](const ExportView& view) {
    return !(view.view->*set).empty();
  });
}

void add_easyvolcap_notes(const ExportInput& input, ExportReport& report) {
  std::string test;  // view_sample of EasyVolcap's configurations: indices of sorted names
  for (std::size_t i = 0; i < input.views.size(); ++i)
    if (input.views[i].is_test) test += fmt::format("{}{}", test.empty() ? "" : ", ", i);
  report.note(fmt::format(
      "split: in a configuration's view_sample; test views are the indices [{}]. Our loader reads "
      "scene.json",
      test
  ));
  if (has_maps(input, &View::truth))
    report.note("gt/ is ground truth of all views: for scores, not for training");
}

void write(const ExportInput& input, const fs::path& folder, ExportReport& report) {
  std::vector<std::string> names;
  std::vector<Camera> cameras;
  for (const ExportView& view : input.views) {
    names.push_back(view.name);
    cameras.push_back(view.view->camera);
  }
  write_opencv_cameras(folder, names, cameras);
  write_pictures(
      input, folder, [](const ExportView& view) { return "images" / frame_of_view(view); }, report
  );
  for_each_view(input, "maps", [&](const ExportView& view) { write_maps(view, folder); });
  report.add("images/<view>/", fmt::format("{} PNG, 8 bit", input.views.size()));
  report.add("intri.yml, extri.yml", count_views(input));
  write_points(input, folder, "sparse/0/points3D.ply", PointNormals::kAsTheyAre, report);
  if (has_maps(input, &View::priors))
    report.add("diffrens/<prior>/<view>/", "PNG, 8 bit; depth in three channels");
  if (has_maps(input, &View::truth)) report.add("gt/<map>/", "EXR floats, masks PNG; ground truth");
  add_easyvolcap_notes(input, report);
}

}  // namespace

GLINT_REGISTER(
    ExporterSpec, {"easyvolcap", "EasyVolcap: EnvGS, GLINT's official code", write, true}
)

}  // namespace glint
