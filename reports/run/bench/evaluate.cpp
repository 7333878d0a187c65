// SPDX-License-Identifier: MIT
#include "reports/run/bench/evaluate.h"

#include "glint/core/presence.h"
#include "glint/scene/image_files.h"
#include "reports/run/records/run_folder.h"

namespace glint {

namespace {

// Pixels that do not count are right, and no glass, in whatever a metric makes of them.
void settle_uncounted(const View& view, MaskView counted, MapSet& rendered) {
  take_reference_where_uncounted(counted, view.rgb, rendered["rgb"]);
  rendered.for_each([&](const MapRow& row, Image& map) {
    if (row.kind == MapKind::kShare)
      take_reference_where_uncounted(counted, Image(counted.width, counted.height, 1), map);
  });
}

Image read_map(const fs::path& path, int channels, ImageSize size) {
  if (!is_there(path)) return {};
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

Scores score_rendered(MapSet rendered, const View& view) {
  const MaskImage counted = mask_of_map(view.counted), glass = mask_of_map(view.truth["glass"]);
  if (!counted.empty()) settle_uncounted(view, counted, rendered);
  ViewPair pair = view_pair(rendered, view, glass);
  if (!counted.empty()) pair.counted = counted;
  return evaluate_view(pair);
}

Scores score_view(const fs::path& folder, const View& view) {
  Scores scores = score_rendered(read_scored_maps(folder, view.rgb.size()), view);
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
