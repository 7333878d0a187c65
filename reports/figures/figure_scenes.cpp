// SPDX-License-Identifier: MIT
#include "reports/figures/figure_scenes.h"

#include <algorithm>

#include "glint/core/progress.h"
#include "reports/page/page_scenes.h"

namespace glint {

namespace {

std::size_t glass_pixels(const View& view) {
  const auto mask = view.truth["glass"].values();
  return static_cast<std::size_t>(std::count_if(mask.begin(), mask.end(), [](float glass) {
    return glass != 0;
  }));
}

struct Truth {
  Scene scene;
  fs::path folder;
};

// Of the first run whose data can be loaded.
std::optional<Truth> load_truth(const PageScene& scene, const FigureOptions& options) {
  std::string reason = "no run folder says which data it was scored against";
  for (const PageRun& run : scene.runs) {
    if (!run.spec) continue;
    try {
      return Truth{options.load(*run.spec), run.spec->dataset_folder};
    } catch (const Error& error) {
      reason = error.what();
    }
  }
  log::warn(fmt::format("figures: {} is left out: {}", scene.name, reason));
  return std::nullopt;
}

FigureScene figure_scene(const PageScene& scene, const Truth& truth) {
  const Scene& data = truth.scene;
  const View& view = data.test[figure_view(data.test)];
  FigureScene result;
  result.name = scene.name;
  result.view = view.name;
  result.glass = mask_of_map(view.truth["glass"]);
  result.truth = true_layers(view);
  result.data = truth.folder;
  result.camera = view.camera;
  for (const View& train : data.train) result.train_cameras.push_back(train.camera);
  std::vector<fs::path> folders;
  for (const PageRun& run : scene.runs) {
    if (!run.record->ok() || result.methods.count(run.record->cell.method)) continue;
    folders.push_back(run.folder);
    result.runs[run.record->cell.method] = run.folder;
    result.methods[run.record->cell.method] =
        rendered_layers(view_folder(run.folder, view.name), &view);
  }
  result.scale = depth_scale(folders, data.test);
  return result;
}

}  // namespace

std::size_t figure_view(const std::vector<View>& views) {
  const auto most = std::max_element(views.begin(), views.end(), [](const View& a, const View& b) {
    return glass_pixels(a) < glass_pixels(b);
  });
  if (most == views.end() || glass_pixels(*most) == 0) return views.size() / 2;
  return static_cast<std::size_t>(most - views.begin());
}

LegendLine views_line(const std::vector<FigureScene>& scenes) {
  std::string views;
  for (const FigureScene& scene : scenes)
    views += fmt::format("{}{} of {}", views.empty() ? "" : ", ", scene.view, scene.name);
  return {fmt::format("views: {} ({})", views, kViewRule)};
}

std::vector<FigureScene> figure_scenes(
    const std::vector<Record>& records, const FigureOptions& options
) {
  std::vector<FigureScene> scenes;
  for (const PageScene& scene : page_scenes(records, options.folder))
    if (const auto truth = load_truth(scene, options); truth && !truth->scene.test.empty())
      scenes.push_back(figure_scene(scene, *truth));
  return scenes;
}

}  // namespace glint
