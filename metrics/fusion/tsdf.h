// SPDX-License-Identifier: MIT
// Meshes from depth maps: a truncated signed distance field [Curless96] averaged over the views,
// marching cubes, small pieces dropped. Deterministic for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "glint/core/config.h"
#include "glint/core/image.h"
#include "glint/core/triangle_mesh.h"
#include "glint/scene/camera.h"
#include "metrics/mesh/mesh_protocol.h"

namespace glint {

struct TsdfOptions {
  double voxel = 0.01;           // metres
  double truncation_voxels = 4;  // distance field cut off there, in voxels
  double max_depth = 0;          // metres; 0: the diagonal of the bounds, without bounds none
  std::array<double, 3> bounds_min{}, bounds_max{};  // metres; equal: none
  int min_cluster = 50;                              // triangles of the smallest piece kept
  double max_memory_mb = 0;                          // 0: half of the machine's

  bool bounded() const { return bounds_min != bounds_max; }

  template <class V>
  void visit(V&& v) {
    v("voxel", voxel, "edge of a voxel in metres");
    v("truncation_voxels", truncation_voxels, "where the distance is cut off, in voxels");
    v("max_depth", max_depth, "metres; farther depths do not count; 0: the bounds' diagonal");
    v("bounds_min", bounds_min, "corner of the box that counts, metres; equal corners: no box");
    v("bounds_max", bounds_max, "its opposite corner");
    v("min_cluster", min_cluster, "triangles of the smallest connected piece that is kept");
    v("max_memory_mb", max_memory_mb, "of voxels and mesh; 0: half of the machine's memory");
  }
};

// Errors (kUsage): a number that no fusion can have; the message names the field.
void check_tsdf_options(const TsdfOptions& options);

// How meshes of those voxels are compared: two voxels in front of a face do not hide it.
inline MeshProtocol mesh_protocol_for(const TsdfOptions& options) {
  MeshProtocol protocol;
  protocol.cull_tolerance_m = 2 * options.voxel;
  return protocol;
}

struct FusionView {
  Image depth;  // [H][W][1] planar z in metres; 0 or not finite: none
  Image rgb;    // [H][W][3] in [0, 1] as displayed; empty: grey
  Camera camera;
};
// The view of an index. Called twice for each, so that one is in memory at a time.
using FusionSource = std::function<FusionView(std::size_t)>;

struct TsdfReport {
  std::size_t num_views = 0, num_depths = 0;  // depths: pixels that counted
  double memory_mb = 0;                       // of voxels and mesh, 10^6 bytes
  std::size_t fused_triangles = 0;            // before pieces were dropped
  std::size_t triangles = 0, clusters = 0, dropped_clusters = 0;

  template <class V>
  void visit(V&& v) {
    v("num_views", num_views, "");
    v("num_depths", num_depths, "");
    v("memory_mb", memory_mb, "");
    v("fused_triangles", fused_triangles, "");
    v("triangles", triangles, "");
    v("clusters", clusters, "");
    v("dropped_clusters", dropped_clusters, "");
  }
};

// Errors: kUsage (options that make no sense; more memory than allowed: the message says how much
// and which voxel would fit), kBadPrediction (no depth counts; depth or rgb of another size than
// the camera; nothing left after dropping pieces), kEnvironment (make_tsdf_volume).
TriangleMesh fuse_depth(
    const FusionSource& view,
    std::size_t num_views,
    const TsdfOptions& options,
    TsdfReport* report = nullptr
);

// The faces of connected pieces of at least `min_triangles`, and the vertices they use; cleaned
// (metrics/mesh/clean.h) first.
struct ClusterCount {
  std::size_t found = 0, dropped = 0;
};
TriangleMesh keep_large_clusters(
    const TriangleMesh& mesh, int min_triangles, ClusterCount* count = nullptr
);

}  // namespace glint
