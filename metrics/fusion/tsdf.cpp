// SPDX-License-Identifier: MIT
#include "metrics/fusion/tsdf.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "glint/core/error.h"
#include "glint/core/machine.h"
#include "glint/core/progress.h"
#include "metrics/fusion/tsdf_volume.h"

namespace glint {
namespace {

constexpr int kBlockVoxels = 16;  // edge of Open3D's unit of allocation, in voxels

double depth_limit(const TsdfOptions& options) {
  if (options.max_depth > 0) return options.max_depth;
  if (!options.bounded()) return std::numeric_limits<double>::infinity();
  double diagonal2 = 0;
  for (std::size_t i = 0; i < 3; ++i)
    diagonal2 += std::pow(options.bounds_max[i] - options.bounds_min[i], 2);
  return std::sqrt(diagonal2);
}

bool inside(const TsdfOptions& options, Vec3d p) {
  const double at[3] = {p.x, p.y, p.z};
  for (std::size_t i = 0; i < 3; ++i)
    if (at[i] < options.bounds_min[i] || at[i] > options.bounds_max[i]) return false;
  return true;
}

Vec3d unproject(const Camera& camera, int x, int y, double depth) {
  return camera.to_world(depth * camera.ray_in_cam(x + 0.5, y + 0.5));
}

// Depths that do not count become 0; returns how many count.
std::size_t keep_valid(FusionView& view, const TsdfOptions& options) {
  const double limit = depth_limit(options);
  std::size_t kept = 0;
  for (int y = 0; y < view.depth.height(); ++y)
    for (int x = 0; x < view.depth.width(); ++x) {
      float& depth = view.depth.at(x, y);
      const double z = static_cast<double>(depth);
      const bool valid = z > 0 && z < limit && std::isfinite(z) &&
                         (!options.bounded() || inside(options, unproject(view.camera, x, y, z)));
      if (valid)
        ++kept;
      else
        depth = 0;
    }
  return kept;
}

// Half of the largest depth that counts; without a limit, of the view's as it was made.
double usual_depth(const FusionView& view, const TsdfOptions& options) {
  double largest = depth_limit(options);
  if (std::isfinite(largest)) return largest / 2;
  largest = 0;
  for (const float depth : view.depth.values())
    if (std::isfinite(depth)) largest = std::max(largest, static_cast<double>(depth));
  return largest / 2;
}

// Every so many pixels open blocks: as few as leave no block of a surface out, with a factor of two
// to spare. A pixel between two surfaces, as splats render them at edges, opens blocks where
// nothing is; the fewer are asked, the fewer of those.
int depth_stride(const FusionView& view, const TsdfOptions& options) {
  constexpr double kMost = 4;                                        // Open3D's own
  const double pixel = usual_depth(view, options) / view.camera.fx;  // metres across
  return static_cast<int>(std::clamp(kBlockVoxels * options.voxel / 2 / pixel, 1.0, kMost));
}

using Block = std::array<std::int32_t, 3>;

// Blocks are counted in 32 bits.
void check_block_numbers(Vec3d p, const TsdfOptions& options, double edge) {
  constexpr double kMost = 1e9;
  const double farthest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  GLINT_CHECK(
      farthest / edge < kMost,
      kUsage,
      "voxel is {:g} m, too small for depths {:g} m from the origin; set bounds, or a larger voxel",
      options.voxel,
      farthest
  );
}

// The blocks that Open3D opens for a view: all that come within the truncation distance of a depth.
// Ends early once there are more than `most`.
void add_blocks(
    const FusionView& view,
    const TsdfOptions& options,
    int stride,
    std::size_t most,
    std::set<Block>& blocks
) {
  const double edge = options.voxel * kBlockVoxels;
  const double truncation = options.voxel * options.truncation_voxels;
  const auto index = [&](double at) { return static_cast<std::int32_t>(std::floor(at / edge)); };
  for (int y = 0; y < view.depth.height(); y += stride)
    for (int x = 0; x < view.depth.width(); x += stride) {
      if (!(view.depth.at(x, y) > 0)) continue;
      const Vec3d p = unproject(view.camera, x, y, static_cast<double>(view.depth.at(x, y)));
      check_block_numbers(p, options, edge);
      if (blocks.size() > most) return;
      for (std::int32_t i = index(p.x - truncation); i <= index(p.x + truncation); ++i)
        for (std::int32_t j = index(p.y - truncation); j <= index(p.y + truncation); ++j)
          for (std::int32_t k = index(p.z - truncation); k <= index(p.z + truncation); ++k)
            blocks.insert({i, j, k});
    }
}

// Of the voxels, and of the mesh that is taken out while they are still there: Open3D's triangles
// with their share of vertices and of the table of edges, two for each voxel of a surface through a
// block.
double megabytes(std::size_t num_blocks, std::size_t bytes_per_voxel) {
  constexpr double kVoxels = kBlockVoxels * kBlockVoxels * kBlockVoxels;
  constexpr double kTriangleBytes = 90;  // measured
  constexpr double kMeshBytes = 2 * kBlockVoxels * kBlockVoxels * kTriangleBytes;
  const double block = static_cast<double>(bytes_per_voxel) * kVoxels + kMeshBytes;
  return static_cast<double>(num_blocks) * block / 1e6;
}

double allowed_megabytes(const TsdfOptions& options) {
  if (options.max_memory_mb > 0) return options.max_memory_mb;
  return static_cast<double>(this_machine().memory_bytes) / 2e6;
}

void check_sizes(const FusionView& view, std::size_t index) {
  const ImageSize size = view.camera.size();
  GLINT_CHECK(
      view.depth.size() == size && (view.rgb.empty() || view.rgb.size() == size),
      kBadPrediction,
      "view {}: depth of {}x{} pixels for a camera of {}x{}; fuse maps of the cameras' size",
      index,
      view.depth.width(),
      view.depth.height(),
      size.width,
      size.height
  );
}

// One that would fit, if the views not yet looked at need as much as those before. Surfaces take
// blocks as the square of 1 / voxel; half as much again for what this does not see.
double larger_voxel(
    const TsdfOptions& options, double excess, std::size_t num_seen, std::size_t num_views
) {
  const double unseen = static_cast<double>(num_views) / static_cast<double>(num_seen);
  return options.voxel * std::sqrt(1.5 * excess * unseen);
}

// Memory is known before any is taken: voxels lie in blocks around the depths.
void estimate(
    const FusionSource& source,
    std::size_t n,
    const TsdfOptions& options,
    std::size_t bytes_per_voxel,
    TsdfReport& report
) {
  std::set<Block> blocks;
  for (std::size_t i = 0; i < n; ++i) {
    FusionView view = source(i);
    check_sizes(view, i);
    const int stride = depth_stride(view, options);
    report.num_depths += keep_valid(view, options);
    const double allowed = allowed_megabytes(options);
    const auto most = static_cast<std::size_t>(allowed / megabytes(1, bytes_per_voxel));
    add_blocks(view, options, stride, most, blocks);
    const double needed = megabytes(blocks.size(), bytes_per_voxel);
    GLINT_CHECK(
        needed <= allowed,
        kUsage,
        "voxels of {} m need {:.0f} MB after {} of {} views, allowed are {:.0f}; set bounds or "
        "max_depth, or a voxel of {:.3g} m",
        options.voxel,
        needed,
        i + 1,
        n,
        allowed,
        larger_voxel(options, needed / allowed, i + 1, n)
    );
  }
  report.num_views = n;
  report.memory_mb = megabytes(blocks.size(), bytes_per_voxel);
  GLINT_CHECK(
      report.num_depths > 0,
      kBadPrediction,
      "no depth to fuse in {} views: all are 0, not finite, beyond {:.3g} m or out of bounds",
      n,
      depth_limit(options)
  );
}

TriangleMesh integrate_all(
    const FusionSource& source, std::size_t n, const TsdfOptions& options, TsdfVolume& volume
) {
  Progress progress("fuse", n);
  for (std::size_t i = 0; i < n; ++i) {
    FusionView view = source(i);
    const int stride = depth_stride(view, options);
    keep_valid(view, options);
    volume.integrate(view.depth, view.rgb.empty() ? ImageView{} : view.rgb, view.camera, stride);
    progress.advance();
  }
  return volume.extract();
}

std::unique_ptr<TsdfVolume> make_volume(const TsdfOptions& options) {
  return make_tsdf_volume({options.voxel, options.voxel * options.truncation_voxels, kBlockVoxels});
}

}  // namespace

TriangleMesh fuse_depth(
    const FusionSource& view, std::size_t num_views, const TsdfOptions& options, TsdfReport* report
) {
  check_tsdf_options(options);
  TsdfReport local;
  GLINT_CHECK(num_views > 0, kBadPrediction, "no view to fuse");
  auto volume = make_volume(options);
  estimate(view, num_views, options, volume->bytes_per_voxel(), local);
  const TriangleMesh fused = integrate_all(view, num_views, options, *volume);
  volume.reset();  // pieces need memory of their own
  local.fused_triangles = fused.faces.size();
  ClusterCount clusters;
  TriangleMesh mesh = keep_large_clusters(fused, options.min_cluster, &clusters);
  local.triangles = mesh.faces.size();
  local.clusters = clusters.found, local.dropped_clusters = clusters.dropped;
  GLINT_CHECK(
      !mesh.faces.empty(),
      kBadPrediction,
      "{} depths give {} triangles, none in a piece of {}; use a larger voxel or a smaller "
      "min_cluster",
      local.num_depths,
      local.fused_triangles,
      options.min_cluster
  );
  if (report != nullptr) *report = local;
  return mesh;
}

}  // namespace glint
