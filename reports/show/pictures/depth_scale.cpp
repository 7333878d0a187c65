// SPDX-License-Identifier: MIT
#include "reports/show/pictures/depth_scale.h"

#include <algorithm>
#include <cmath>

#include "glint/core/presence.h"
#include "glint/scene/image_files.h"
#include "reports/run/records/run_folder.h"

namespace glint {

namespace {

void add_depths(const Image& depth, std::vector<float>& depths) {
  for (const float z : depth.values())
    if (std::isfinite(z) && z > 0) depths.push_back(z);
}

std::vector<MapRow> depth_maps() {
  std::vector<MapRow> rows;
  for (const MapRow& row : maps())
    if (row.kind == MapKind::kDepth) rows.push_back(row);
  return rows;
}

float percentile(std::vector<float>& values, std::size_t percent) {
  const std::size_t rank = (values.size() - 1) * percent / 100;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

DepthScale depth_scale(const std::vector<fs::path>& runs, const std::vector<View>& views) {
  std::vector<float> depths;
  for (const View& view : views) {
    for (const MapRow& row : depth_maps()) add_depths(view.truth[row], depths);
  }
  const bool from_truth = !depths.empty();
  for (const fs::path& run : runs)
    for (const View& view : views) {
      if (from_truth) continue;
      for (const MapRow& row : depth_maps())
        if (const fs::path file = view_folder(run, view.name) / row.file;
            or_warn([&] { return is_file(file); }))
          add_depths(read_image(file, 1), depths);
    }
  if (depths.empty()) return {};
  return {percentile(depths, 1), percentile(depths, 99), from_truth};
}

}  // namespace glint
