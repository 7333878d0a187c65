// SPDX-License-Identifier: MIT
// The results of a metric program as text for people, as CSV, and as one JSON document.
#pragma once

#include <iosfwd>
#include <vector>

#include "metrics/tools/tool.h"

namespace glint {

struct ToolReport {
  fs::path prediction, reference, mask, glass;
  std::vector<ImageScores> images;
  std::vector<std::string> missing;  // names left out by --allow-missing
};

Json scores_json(const ToolScores& scores);
// A line each: id, value with two digits more than tables print, unit.
void print_scores(const ToolScores& scores, std::ostream& out);

// Mean over the images that have the metric, in order of first appearance.
ToolScores mean_scores(std::span<const ImageScores> images);

void print_text(const MetricTool& tool, const ToolReport& report, std::ostream& out);
// A row per image and one named "mean"; unrounded. Warnings are on standard error alone.
void print_csv(const ToolReport& report, std::ostream& out);
// Unrounded numbers, protocols, file names.
Json report_json(const MetricTool& tool, const ToolReport& report);
void print_json(const MetricTool& tool, const ToolReport& report, std::ostream& out);

}  // namespace glint
