// SPDX-License-Identifier: MIT
#include "reports/bench/evaluate.h"

#include "glint/scene/image_files.h"
#include "reports/records/run_folder.h"

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

}  // namespace

MapSet read_scored_maps(const fs::path& folder, ImageSize size) {
  MapSet rendered;
  const bool eight_bit = is_eight_bit_render(folder);
  for (const MapRow& row : maps()) {
    if (row.file.empty()) continue;
    const fs::path path = eight_bit ? render_file(folder, row) : folder / row.file;
    rendered[row] = read_map(path, row.channels(), size);
  }
  GLINT_CHECK(
      rendered.has("rgb"),
      kBadPrediction,
      "{}: no rgb.exr; run `glint-bench render` first",
      folder.string()
  );
  return rendered;
}

ViewPair view_pair(const MapSet& rendered, const View& view, const MaskImage& glass) {
  ViewPair pair{views_of(rendered), views_of(view.truth), {}};
  pair.truth["rgb"] = view.rgb;
  if (!glass.empty()) pair.glass = glass;
  return pair;
}

Scores score_view(const fs::path& folder, const View& view) {
  const MapSet rendered = read_scored_maps(folder, view.rgb.size());
  Scores scores = evaluate_view(view_pair(rendered, view, mask_of_map(view.truth["glass"])));
  if (is_eight_bit_render(folder))
    std::erase_if(scores, [](const auto& score) {
      return score.first == "psnr" || score.first.starts_with("psnr@");
    });
  return scores;
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
