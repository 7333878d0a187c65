// SPDX-License-Identifier: MIT
#include "metrics/mesh/mesh_scores.h"

#include <algorithm>
#include <cmath>

#include "metrics/reduce.h"

namespace glint {
namespace {

DirectionScores direction_scores(const DirectedDistances& directed, double max_distance) {
  DirectionScores scores;
  scores.num_samples = directed.distances.size();
  Sum squares, clipped, cosines;
  for (const double distance : directed.distances) {
    scores.mean_m += distance;
    scores.max_m = std::max(scores.max_m, distance);
    squares += {distance * distance, 1};
    clipped += {max_distance > 0 && distance >= max_distance ? 1.0 : 0.0, 1};
  }
  for (const float cosine : directed.normal_cosines)
    if (cosine >= 0) cosines += {static_cast<double>(cosine), 1};
  scores.mean_m /= static_cast<double>(scores.num_samples);
  scores.rms_m = std::sqrt(squares.mean().value_or(0));
  scores.clipped = clipped.mean().value_or(0);
  scores.normal_consistency = cosines.mean();
  return scores;
}

std::vector<double> sorted(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values;
}

double share_below(const std::vector<double>& ascending, double threshold) {
  const auto end = std::lower_bound(ascending.begin(), ascending.end(), threshold);
  return static_cast<double>(end - ascending.begin()) / static_cast<double>(ascending.size());
}

double harmonic_mean(double precision, double recall) {
  return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0;
}

}  // namespace

std::vector<ThresholdScores> f1_curve(
    const SurfaceDistances& distances, std::span<const double> thresholds_m
) {
  const std::vector<double> accuracy = sorted(distances.accuracy.distances);
  const std::vector<double> completeness = sorted(distances.completeness.distances);
  std::vector<ThresholdScores> curve;
  for (const double threshold : thresholds_m) {
    const double precision = share_below(accuracy, threshold);
    const double recall = share_below(completeness, threshold);
    curve.push_back({threshold, precision, recall, harmonic_mean(precision, recall)});
  }
  return curve;
}

MeshScores mesh_scores(const SurfaceDistances& distances, const MeshProtocol& protocol) {
  MeshScores scores;
  scores.accuracy = direction_scores(distances.accuracy, protocol.max_distance_m);
  scores.completeness = direction_scores(distances.completeness, protocol.max_distance_m);
  scores.chamfer_m = (scores.accuracy.mean_m + scores.completeness.mean_m) / 2;
  const auto &there = scores.accuracy.normal_consistency,
             &back = scores.completeness.normal_consistency;
  if (there && back) scores.normal_consistency = (*there + *back) / 2;
  scores.thresholds = f1_curve(distances, protocol.thresholds_m);
  return scores;
}

MeshScores mesh_scores(
    const Surface& prediction, const Surface& reference, const MeshProtocol& protocol
) {
  return mesh_scores(surface_distances(prediction, reference, protocol), protocol);
}

std::vector<std::pair<std::string, double>> mesh_values(
    const MeshScores& scores, const MeshProtocol& protocol
) {
  std::vector<std::pair<std::string, double>> values;
  const auto add = [&](const std::string& stem, double value) {
    values.emplace_back(mesh_metric_id(stem, protocol), value);
  };
  add("cd", scores.chamfer_m);
  add("accuracy", scores.accuracy.mean_m);
  add("completeness", scores.completeness.mean_m);
  for (const ThresholdScores& at : scores.thresholds) {
    const std::string name = threshold_name(at.threshold_m);
    add("f1@" + name, at.f1);
    add("precision@" + name, at.precision);
    add("recall@" + name, at.recall);
  }
  if (scores.normal_consistency) add("normal", *scores.normal_consistency);
  return values;
}

}  // namespace glint
