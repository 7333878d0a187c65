// SPDX-License-Identifier: MIT
#include "metrics/tools/dataset_views.h"

#include <algorithm>

#include "datasets/dataset.h"
#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

// What a run folder says about the size of its views; 0: nothing.
double max_pixels_of(const fs::path& run) {
  const fs::path config = run / "config.json";
  if (!is_file(config)) return 0;
  const Json json = parse_json(read_file(config));
  const auto it = json.is_object() ? json.find("max_pixels") : json.end();
  return json.is_object() && it != json.end() && it->is_number() ? it->get<double>() : 0;
}

Scene load_views(const fs::path& dataset, bool all_views, const fs::path& prediction) {
  LoadOptions options;
  options.with_priors = false;
  options.test_only = !all_views;
  options.max_pixels = max_pixels_of(prediction);
  return with_exit_code(ExitCode::kBadReference, [&] { return load_scene(dataset, options); });
}

}  // namespace

bool is_dataset(const fs::path& path) {
  if (is_file(path)) return path.extension() == ".safetensors";
  const auto& loaders = Registry<LoaderSpec>::all();
  return std::any_of(loaders.begin(), loaders.end(), [&](const auto& loader) {
    return loader.second.match(path).sureness == Sureness::kContents;
  });
}

DatasetViews::DatasetViews(const fs::path& dataset, bool all_views, const fs::path& prediction)
    : scene_(load_views(dataset, all_views, prediction)) {
  if (all_views)
    for (View& view : scene_.train) scene_.test.push_back(std::move(view));
  scene_.train.clear();
}

std::map<std::string, const View*> DatasetViews::with_map(const std::string& map) const {
  std::map<std::string, const View*> views;
  for (const View& view : scene_.test)
    if (!map_of(view, map).empty()) views[flat_view_name(view.name)] = &view;
  return views;
}

const Image& map_of(const View& view, const std::string& map) {
  if (map == "rgb") return view.rgb;
  const MapRow* row = find_map(map);
  GLINT_CHECK(row != nullptr, kUsage, "no map '{}'", map);
  return view.truth[*row];
}

}  // namespace glint
