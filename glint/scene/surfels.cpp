// SPDX-License-Identifier: MIT
#include "glint/scene/surfels.h"

#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/core/kd_tree.h"
#include "glint/core/parallel.h"
#include "glint/core/rng.h"

namespace glint {
namespace {

constexpr double kMinSpacing = 1e-4;          // metres
constexpr float kSh0 = 0.28209479177387814f;  // 1 / (2 sqrt(pi)): the constant basis function

float logit(float probability) { return std::log(probability / (1 - probability)); }

// Uniform on the rotations: a normal 4-vector has no preferred direction.
void random_rotation(Rng& rng, float* wxyz) {
  float norm2 = 0;
  while (norm2 < 1e-6f) {
    norm2 = 0;
    for (int i = 0; i < 4; ++i) {
      wxyz[i] = rng.normal();
      norm2 += wxyz[i] * wxyz[i];
    }
  }
  for (int i = 0; i < 4; ++i) wxyz[i] /= std::sqrt(norm2);
}

}  // namespace

void SurfelCloud::resize(std::size_t count) {
  for_each_array([count](const char*, FloatArray& array, std::size_t width) {
    array.resize(count * width);
  });
}

std::vector<float> neighbor_distances(std::span<const Vec3f> points) {
  constexpr std::size_t kNeighbors = 3;
  GLINT_CHECK(
      points.size() > kNeighbors,
      kBadReference,
      "{} points, expected at least {}: neighbour distances need {} others",
      points.size(),
      kNeighbors + 1,
      kNeighbors
  );
  const PointsAdaptor adaptor{points};
  const KdTree tree(3, adaptor);
  std::vector<float> distances(points.size());
  parallel_for(points.size(), 256, [&](std::size_t i) {
    const double query[3] = {
        adaptor.kdtree_get_pt(i, 0), adaptor.kdtree_get_pt(i, 1), adaptor.kdtree_get_pt(i, 2)};
    std::uint32_t ids[kNeighbors + 1];
    double squared[kNeighbors + 1];  // ascending; the first is the point itself or a duplicate
    tree.knnSearch(query, kNeighbors + 1, ids, squared);
    const double mean = (squared[1] + squared[2] + squared[3]) / kNeighbors;
    distances[i] = static_cast<float>(std::max(std::sqrt(mean), kMinSpacing));
  });
  return distances;
}

SurfelCloud surfels_from_points(const PointCloud& points, const InitialSurfels& options) {
  const std::vector<float> spacing = neighbor_distances(points.positions);
  SurfelCloud cloud;
  for (const ExtraChannel& extra : options.extra) cloud.extra_names.push_back(extra.name);
  cloud.resize(points.positions.size());
  std::fill(cloud.opacity_logits.begin(), cloud.opacity_logits.end(), logit(options.opacity));
  Rng rng(options.seed, hash_name("surfel rotations"));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    random_rotation(rng, &cloud.rotations[4 * i]);
    cloud.log_scales[2 * i] = cloud.log_scales[2 * i + 1] = std::log(spacing[i]);
    for (int c = 0; c < 3; ++c) {
      const std::size_t at = 3 * i + static_cast<std::size_t>(c);
      cloud.means[at] = points.positions[i][c];
      cloud.sh_dc[at] = (points.colors[i][c] - 0.5f) / kSh0;
    }
    for (std::size_t e = 0; e < cloud.num_extra(); ++e)
      cloud.extra_logits[i * cloud.num_extra() + e] = logit(options.extra[e].initial);
  }
  return cloud;
}

}  // namespace glint
