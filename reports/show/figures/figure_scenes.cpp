// SPDX-License-Identifier: MIT
#include "reports/show/figures/figure_scenes.h"

#include <algorithm>
#include <set>

#include "glint/core/progress.h"
#include "reports/show/page/page_scenes.h"

namespace glint {

namespace {

constexpr const char* kSecondLayer = "layer_2_depth";

std::size_t glass_pixels(const View& view) {
  const auto mask = view.truth["glass"].values();
  return static_cast<std::size_t>(std::count_if(mask.begin(), mask.end(), [](float glass) {
    return glass != 0;
  }));
}

bool is_shown(const std::string& scene, const FigureView& shown) {
  const auto matches = [&](const std::string& glob) { return glob_match(glob, scene); };
  return shown.scenes.empty() || std::any_of(shown.scenes.begin(), shown.scenes.end(), matches);
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

const View& shown_view(const Scene& data, const std::string& name) {
  if (name.empty()) return data.test[figure_view(data.test)];
  std::string names;
  for (const View& view : data.test) {
    if (view.name == name) return view;
    names += (names.empty() ? "" : ", ") + view.name;
  }
  throw Error(
      ExitCode::kUsage, fmt::format("{} has no test view {}; it has {}", data.name, name, names)
  );
}

void check_inside(const Crop& crop, const Camera& camera, const std::string& scene) {
  GLINT_CHECK(
      crop.left + crop.width <= camera.width && crop.top + crop.height <= camera.height,
      kUsage,
      "crop {},{},{},{} reaches out of the views of {}, which have {}x{} pixels",
      crop.left,
      crop.top,
      crop.width,
      crop.height,
      scene,
      camera.width,
      camera.height
  );
}

// Without the priors, which no figure shows.
std::shared_ptr<const View> kept_view(const View& view) {
  auto kept = std::make_shared<View>(view);
  kept->priors = {};
  return kept;
}

FigureScene figure_scene(const PageScene& scene, const Truth& truth, const FigureView& shown) {
  const Scene& data = truth.scene;
  const View& view = shown_view(data, shown.view);
  FigureScene result;
  for (const std::string& text : shown.crops) {
    result.crops.push_back(parse_crop(text, result.crops.size()));
    check_inside(result.crops.back(), view.camera, scene.name);
  }
  result.name = scene.name;
  result.view = view.name;
  result.chosen_view = !shown.view.empty();
  result.glass = mask_of_map(view.truth["glass"]);
  result.truth = true_layers(view);
  result.data = truth.folder;
  result.camera = view.camera;
  for (const View& train : data.train) result.train_cameras.push_back(train.camera);
  std::vector<fs::path> folders;
  const auto kept = kept_view(view);
  for (const PageRun& run : scene.runs) {
    if (!run.record->ok() || result.methods.count(run.record->cell.method)) continue;
    folders.push_back(run.folder);
    result.runs[run.record->cell.method] = run.folder;
    result.methods[run.record->cell.method] = {view_folder(run.folder, view.name), kept};
  }
  result.scale = depth_scale(folders, data.test);
  return result;
}

}  // namespace

bool FigureLayers::has(const std::string& id) const {
  return view_ ? has_rendered_layer(folder_, id, *view_) : maps_.contains(id);
}

Image FigureLayers::at(const std::string& id) const {
  if (view_) return rendered_layer(folder_, id, *view_);
  const auto it = maps_.find(id);
  return it == maps_.end() ? Image() : it->second;
}

std::size_t figure_view(const std::vector<View>& views) {
  const auto most = std::max_element(views.begin(), views.end(), [](const View& a, const View& b) {
    return glass_pixels(a) < glass_pixels(b);
  });
  if (most == views.end() || glass_pixels(*most) == 0) return views.size() / 2;
  return static_cast<std::size_t>(most - views.begin());
}

std::vector<FigureScene> with_chosen_methods(
    std::vector<FigureScene> scenes, const MethodChoice& choice
) {
  for (FigureScene& scene : scenes) {
    const bool is_layered = choice.globs.empty() && scene.truth.has(kSecondLayer);
    std::set<std::string> left_out;
    for (const auto& [id, layers] : scene.methods)
      if (!choice.in_pictures(id) && !(is_layered && layers.has(kSecondLayer))) left_out.insert(id);
    for (const std::string& id : left_out) scene.methods.erase(id), scene.runs.erase(id);
  }
  return scenes;
}

LegendLine views_line(const std::vector<FigureScene>& scenes) {
  std::string views;
  for (const FigureScene& scene : scenes)
    views += fmt::format("{}{} of {}", views.empty() ? "" : ", ", scene.view, scene.name);
  const bool chosen = !scenes.empty() && scenes.front().chosen_view;
  return {chosen ? "views: " + views : fmt::format("views: {} ({})", views, kViewRule)};
}

std::vector<FigureScene> figure_scenes(
    const std::vector<Record>& records, const FigureOptions& options
) {
  std::vector<FigureScene> scenes;
  std::string names;
  bool any_shown = false;
  for (const PageScene& scene : page_scenes(records, options.folder)) {
    names += (names.empty() ? "" : ", ") + scene.name;
    if (!is_shown(scene.name, options.shown)) continue;
    any_shown = true;
    if (const auto truth = load_truth(scene, options); truth && !truth->scene.test.empty())
      scenes.push_back(figure_scene(scene, *truth, options.shown));
  }
  GLINT_CHECK(any_shown || names.empty(), kUsage, "no such scene: the records are of {}", names);
  return scenes;
}

}  // namespace glint
