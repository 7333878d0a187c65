// SPDX-License-Identifier: MIT
#include "metrics/mesh/mesh_protocol.h"

namespace glint {
namespace {

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
