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

constexpr double kMinSpacing = 1e-4;  // metres

float raw_of(Activation activation, float activated) {
  if (activation == Activation::kTanh) return std::atanh(activated);
  return activation == Activation::kCappedExp ? std::log(5 * activated) : logit(activated);
}

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

namespace {

void set_extra(const InitialSurfels& options, SurfelCloud& cloud) {
  Rng rng(options.seed, hash_name("extra channels"));
  for (std::size_t i = 0; i < cloud.extra_logits.size(); ++i) {
    const ExtraChannel& extra = options.extra[i % cloud.num_extra()];
    cloud.extra_logits[i] = raw_of(extra.activation, extra.initial);
    if (extra.spread > 0) cloud.extra_logits[i] += extra.spread * rng.normal();
  }
}

}  // namespace

SurfelCloud surfels_from_points(const PointCloud& points, const InitialSurfels& options) {
  const std::vector<float> spacing = neighbor_distances(points.positions);
  SurfelCloud cloud;
  for (const ExtraChannel& extra : options.extra) {
    cloud.extra_names.push_back(extra.name);
    cloud.extra_activations.push_back(extra.activation);
  }
  cloud.resize(points.positions.size());
  std::fill(cloud.opacity_logits.begin(), cloud.opacity_logits.end(), logit(options.opacity));
  Rng rng(options.seed, hash_name("surfel rotations"));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    random_rotation(rng, &cloud.rotations[4 * i]);
    cloud.log_scales[2 * i] = cloud.log_scales[2 * i + 1] = std::log(options.scale * spacing[i]);
    for (int c = 0; c < 3; ++c) {
      const std::size_t at = 3 * i + static_cast<std::size_t>(c);
      cloud.means[at] = points.positions[i][c];
      cloud.sh_dc[at] = (points.colors[i][c] - 0.5f) / kSh0;
    }
  }
  set_extra(options, cloud);
  return cloud;
}

void set_activations(
    const std::vector<ExtraChannel>& extra, const std::string& file, SurfelCloud& cloud
) {
  std::vector<std::string> expected;
  cloud.extra_activations.clear();
  for (const ExtraChannel& channel : extra) {
    expected.push_back(channel.name);
    cloud.extra_activations.push_back(channel.activation);
  }
  GLINT_CHECK(
      cloud.extra_names == expected,
      kBadPrediction,
      "{}: extra fields [{}], expected [{}]; was it trained by another method?",
      file,
      fmt::join(cloud.extra_names, ", "),
      fmt::join(expected, ", ")
  );
}

}  // namespace glint
