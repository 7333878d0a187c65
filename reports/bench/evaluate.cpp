// SPDX-License-Identifier: MIT
#include "reports/bench/evaluate.h"

#include "glint/scene/image_files.h"
#include "metrics/metric.h"

namespace glint {

namespace {

Image read_map(const fs::path& path, int channels, ImageSize size) {
  if (!fs::exists(path)) return {};
  Image map = read_image(path, channels);
  GLINT_CHECK(
      map.size() == size,
      kBadPrediction,
      "{}: {}x{} pixels, expected {}x{} as the test view; render again",
      path.string(),
      map.width(),
      map.height(),
      size.width,
      size.height
  );
  return map;
}

ImageView view_of(const Image& image) { return image.empty() ? ImageView{} : ImageView(image); }

}  // namespace

Scores score_view(const fs::path& folder, const View& view) {
  const ImageSize size = view.rgb.size();
  const Image rgb = read_map(folder / "rgb.exr", 3, size);
  GLINT_CHECK(
      !rgb.empty(),
      kBadPrediction,
      "{}: no rgb.exr; run `glint-bench render` first",
      folder.string()
  );
  const Image depth = read_map(folder / "depth.exr", 1, size);
  const Image normal = read_map(folder / "normal.exr", 3, size);
  const Image transparency = read_map(folder / "transparency.exr", 1, size);
  const Image specularity = read_map(folder / "specularity.exr", 1, size);
  const Image behind_depth = read_map(folder / "behind_depth.exr", 1, size);
  const Image transmitted = read_map(folder / "transmitted.exr", 3, size);
  const Image reflected = read_map(folder / "reflected.exr", 3, size);

  ViewPair pair;
  pair.rgb = rgb;
  pair.depth = view_of(depth);
  pair.normal = view_of(normal);
  pair.transparency = view_of(transparency);
  pair.specularity = view_of(specularity);
  pair.behind_depth = view_of(behind_depth);
  pair.transmitted = view_of(transmitted);
  pair.reflected = view_of(reflected);
  pair.true_rgb = view.rgb;
  pair.true_depth = view_of(view.truth.depth);
  pair.true_normal = view_of(view.truth.normal);
  pair.true_behind_depth = view_of(view.truth.behind_depth);
  pair.true_transmitted = view_of(view.truth.transmitted);
  pair.true_reflected = view_of(view.truth.reflected);
  if (!view.truth.glass.empty()) pair.glass = view.truth.glass;
  return evaluate_view(pair);
}

Json score_protocols() { return metric_protocols(); }

std::vector<std::string> not_applicable(
    const Scores& means, const std::map<std::string, std::string>& not_measured
) {
  std::vector<std::string> ids;
  for (const MetricFamily& family : metric_families())
    for (const Metric& metric : family.metrics)
      if (!means.contains(metric.id) && !not_measured.contains(metric.id)) ids.push_back(metric.id);
  return ids;
}

Scores mean_scores(const std::vector<Scores>& views) {
  std::map<std::string, std::pair<double, int>> sums;
  for (const Scores& view : views)
    for (const auto& [id, value] : view) {
      sums[id].first += value;
      ++sums[id].second;
    }
  Scores means;
  for (const auto& [id, sum] : sums) means[id] = sum.first / sum.second;
  return means;
}

}  // namespace glint
