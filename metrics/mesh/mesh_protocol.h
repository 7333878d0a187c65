// SPDX-License-Identifier: MIT
// What the comparison of two surfaces depends on, and the ids of its results. Apart from the
// computation, so that every build knows the columns of tables.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "glint/core/config.h"
#include "metrics/metric.h"

namespace glint {

enum class SurfaceDistance {
  kPointToTriangle,  // exact distance of a sample to the other surface
  kPointToPoint,     // to the other surface's nearest sample: a floor that falls with the density
};
NLOHMANN_JSON_SERIALIZE_ENUM(
    SurfaceDistance,
    {{SurfaceDistance::kPointToTriangle, "point-to-triangle"},
     {SurfaceDistance::kPointToPoint, "point-to-point"}}
)

// What was done to both meshes before they were compared (metrics/mesh/cull.h).
enum class MeshCulling { kNone, kCameras };
NLOHMANN_JSON_SERIALIZE_ENUM(
    MeshCulling, {{MeshCulling::kNone, "none"}, {MeshCulling::kCameras, "cameras"}}
)

std::vector<double> default_thresholds_m();  // 1, 2, 5 and 10 cm

// What scoring takes for each sample: points, normals, distances of two meshes, trees over them.
inline constexpr double kBytesPerMeshSample = 600;

struct MeshProtocol {
  std::uint64_t num_samples = 1'000'000;
  std::uint64_t seed = 0;
  SurfaceDistance distance = SurfaceDistance::kPointToTriangle;
  std::vector<double> thresholds_m = default_thresholds_m();
  double max_distance_m = 0;
  MeshCulling cull = MeshCulling::kCameras;
  double cull_tolerance_m = 0.02;  // two voxels of the default extraction
  double cull_max_edge_m = 0.2;
  template <class V>
  void visit(V&& v) {
    v("num_samples", num_samples, "per surface, uniform by area, stratified");
    v("seed", seed, "of the samples");
    v("distance", distance, "point-to-triangle (exact) or point-to-point (nearest sample)");
    v("thresholds_m", thresholds_m, "metres; a sample counts when strictly nearer");
    v("max_distance_m", max_distance_m, "metres; larger distances are set to it; 0: no limit");
    v("cull", cull, "none, or cameras: faces that no training camera sees are left out of both");
    v("cull_tolerance_m", cull_tolerance_m, "metres in front of a face that do not hide it");
    v("cull_max_edge_m", cull_max_edge_m, "metres; faces with longer edges are split before");
  }
};

// Errors (kUsage): no samples; a threshold that is not above 0, or stands there twice; a largest
// distance that is negative, or below a threshold, where it would make every sample count.
void check_mesh_protocol(const MeshProtocol& protocol);

// "5cm", "0.5cm".
std::string threshold_name(double threshold_m);

// The id of a result under a protocol: "mesh-cd", "mesh-f1@5cm-p2p". `stem`: "cd", "f1@5cm".
std::string mesh_metric_id(const std::string& stem, const MeshProtocol& protocol);

// What ids of the surface behind glass begin with: "behind-mesh-cd".
inline constexpr const char* kBehindMesh = "behind-";

// Of both surfaces, the default thresholds and both distances, each with its protocol. Fractions in
// [0, 1] for precision, recall, F1 and normals; metres for the rest. find_metric() knows them.
const std::vector<Metric>& mesh_metric_list();

}  // namespace glint
