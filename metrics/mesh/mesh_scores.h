// SPDX-License-Identifier: MIT
// How near two surfaces are to each other: accuracy (prediction to reference), completeness
// (reference to prediction), Chamfer distance, precision, recall and F1 at thresholds, agreement of
// normals. Everything after the distances themselves needs only them, so other thresholds cost
// nothing.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "metrics/mesh/mesh_protocol.h"
#include "metrics/mesh/samples.h"

namespace glint {

// From the samples of one surface to the other.
struct DirectedDistances {
  std::vector<double> distances;      // metres, at most max_distance_m where there is one
  std::vector<float> normal_cosines;  // |cos| with the normal at the nearest place; -1: unknown
};

struct SurfaceDistances {
  DirectedDistances accuracy, completeness;
};

// Meshes are taken as they are: clean_mesh() and cull_unseen() come before. To a point cloud the
// distance is to its nearest point under either protocol. Errors: check_mesh_protocol()'s;
// kBadPrediction and kBadReference (no faces, no points).
SurfaceDistances surface_distances(
    const Surface& prediction, const Surface& reference, const MeshProtocol& protocol
);

// One direction alone, from any points (normals may be missing), in metres; 0: no limit.
DirectedDistances distances_to(
    const SurfacePoints& from, const Surface& target, double max_distance_m = 0
);

struct DirectionScores {
  double mean_m = 0, rms_m = 0, max_m = 0;
  double clipped = 0;                        // fraction of the samples at max_distance_m
  std::optional<double> normal_consistency;  // mean |cos|; empty: a side has no normals
  std::size_t num_samples = 0;
};

struct ThresholdScores {  // fractions
  double threshold_m = 0, precision = 0, recall = 0;
  double f1 = 0;  // 2PR / (P + R); 0 where both are
  template <class V>
  void visit(V&& v) {
    v("threshold_m", threshold_m, "metres");
    v("precision", precision, "share of the prediction's samples strictly nearer");
    v("recall", recall, "share of the reference's");
    v("f1", f1, "their harmonic mean");
  }
};

struct MeshScores {
  DirectionScores accuracy, completeness;
  double chamfer_m = 0;                      // (accuracy + completeness) / 2, of the means
  std::optional<double> normal_consistency;  // mean of both directions
  std::vector<ThresholdScores> thresholds;   // of the protocol, in its order
};

MeshScores mesh_scores(const SurfaceDistances& distances, const MeshProtocol& protocol);
MeshScores mesh_scores(
    const Surface& prediction, const Surface& reference, const MeshProtocol& protocol
);

// One entry per threshold, in any order.
std::vector<ThresholdScores> f1_curve(
    const SurfaceDistances& distances, std::span<const double> thresholds_m
);

// The values under their ids (mesh_metric_id), as tables and records name them.
std::vector<std::pair<std::string, double>> mesh_values(
    const MeshScores& scores, const MeshProtocol& protocol
);

}  // namespace glint
