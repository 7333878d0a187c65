// SPDX-License-Identifier: MIT
// Every metric of one view, from the files of its render.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "glint/core/config.h"
#include "glint/core/files.h"
#include "glint/scene/scene.h"
#include "metrics/metric.h"

namespace glint {

using Scores = std::map<std::string, double>;  // metric id -> value; "psnr@glass" for a region

// `folder`: renders/<view>. Metrics whose map was not rendered, or that have no ground truth, are
// absent. Errors (kBadPrediction): rgb missing, a file damaged or of another size than the view.
Scores score_view(const fs::path& folder, const View& view);

// The same of maps in memory.
Scores score_rendered(MapSet rendered, const View& view);

// What score_view() scores: every map that has a file, and the pair of those and the truth, which
// borrows all three.
MapSet read_scored_maps(const fs::path& folder, ImageSize size);
ViewPair view_pair(const MapSet& rendered, const View& view, const MaskImage& glass);

// The protocols behind the ids, for metrics.json.
Json score_protocols();

// Metrics of views that neither have a mean nor a reason to be missing: the method renders no such
// map, or the data have no truth for it. Regions are left out.
std::vector<std::string> not_applicable(
    const Scores& means, const std::map<std::string, std::string>& not_measured
);

// Mean of each metric over the views that have it.
Scores mean_scores(const std::vector<Scores>& views);

}  // namespace glint
