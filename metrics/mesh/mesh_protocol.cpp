// SPDX-License-Identifier: MIT
#include "metrics/mesh/mesh_protocol.h"

#include <cmath>
#include <set>

#include "glint/core/error.h"

namespace glint {
namespace {

// Two that share a name would share the ids of their results.
void check_thresholds(const std::vector<double>& thresholds_m) {
  std::set<std::string> names;
  for (const double threshold : thresholds_m) {
    GLINT_CHECK(
        std::isfinite(threshold) && threshold > 0,
        kUsage,
        "thresholds_m: {}; expected metres above 0",
        threshold
    );
    GLINT_CHECK(
        names.insert(threshold_name(threshold)).second,
        kUsage,
        "thresholds_m (--thresholds): {} stands there twice ({}); expected each once",
        threshold,
        threshold_name(threshold)
    );
  }
}

void check_max_distance(double max_distance_m, const std::vector<double>& thresholds_m) {
  GLINT_CHECK(
      max_distance_m >= 0,
      kUsage,
      "max_distance_m: {}; expected metres, or 0 for no limit",
      max_distance_m
  );
  for (const double threshold : thresholds_m)
    GLINT_CHECK(
        max_distance_m == 0 || max_distance_m >= threshold,
        kUsage,
        "max_distance_m (--max-distance) is {}, below {} of thresholds_m (--thresholds), where F1 "
        "would be 1 for any surface; raise it, or leave the threshold out",
        max_distance_m,
        threshold
    );
}

void append_metrics(
    const std::string& prefix, const MeshProtocol& protocol, std::vector<Metric>& list
) {
  const Json json = config_to_json(protocol);
  const auto add = [&](const std::string& stem, const char* unit, Direction direction, int digits) {
    list.push_back({prefix + mesh_metric_id(stem, protocol), unit, direction, digits, json});
  };
  for (const char* stem : {"cd", "accuracy", "completeness"})
    add(stem, "m", Direction::kLowerIsBetter, 4);
  for (const double threshold : protocol.thresholds_m)
    for (const char* stem : {"f1@", "precision@", "recall@"})
      add(stem + threshold_name(threshold), "", Direction::kHigherIsBetter, 3);
  add("normal", "", Direction::kHigherIsBetter, 3);
}

}  // namespace

void check_mesh_protocol(const MeshProtocol& protocol) {
  GLINT_CHECK(protocol.num_samples > 0, kUsage, "num_samples is 0; expected at least 1");
  GLINT_CHECK(!protocol.thresholds_m.empty(), kUsage, "thresholds_m is empty; expected metres");
  for (const auto& [field, metres] :
       {std::pair{"cull_tolerance_m", protocol.cull_tolerance_m},
        {"cull_max_edge_m", protocol.cull_max_edge_m}})
    GLINT_CHECK(metres >= 0, kUsage, "{} is {}; expected metres, or 0", field, metres);
  check_thresholds(protocol.thresholds_m);
  check_max_distance(protocol.max_distance_m, protocol.thresholds_m);
}

std::vector<double> default_thresholds_m() { return {0.01, 0.02, 0.05, 0.10}; }

std::string threshold_name(double threshold_m) { return fmt::format("{:g}cm", 100 * threshold_m); }

std::string mesh_metric_id(const std::string& stem, const MeshProtocol& protocol) {
  const bool exact = protocol.distance == SurfaceDistance::kPointToTriangle;
  return "mesh-" + stem + (exact ? "" : "-p2p");
}

const std::vector<Metric>& mesh_metric_list() {
  static const std::vector<Metric> list = [] {
    std::vector<Metric> metrics;
    for (const char* prefix : {"", kBehindMesh})
      for (const auto distance :
           {SurfaceDistance::kPointToTriangle, SurfaceDistance::kPointToPoint}) {
        MeshProtocol protocol;
        protocol.distance = distance;
        append_metrics(prefix, protocol, metrics);
      }
    return metrics;
  }();
  return list;
}

}  // namespace glint
