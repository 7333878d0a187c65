// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/core/rng.h"
#include "metrics/mesh/mesh_scores.h"
#include "metrics/mesh/point_tree.h"
#include "metrics/mesh/triangle_tree.h"

namespace glint {
namespace {

constexpr std::size_t kBlock = 4096;  // samples; the first of each starts without a guess

// A surface's samples must not be those of its copy: point to point would find each itself.
constexpr std::uint64_t kReferenceStream = hash_name("reference");

bool has_content(const Surface& surface) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&surface)) return !mesh->faces.empty();
  return !std::get<SurfacePoints>(surface).positions.empty();
}

// Normals at the places that a tree's ids name; empty when there are none.
float normal_cosine(
    const std::vector<Vec3f>& normals,
    std::size_t sample,
    const std::vector<Vec3f>& target_normals,
    std::int32_t target
) {
  if (normals.empty() || target_normals.empty() || target < 0) return -1;
  const float cosine = dot(normals[sample], target_normals[static_cast<std::size_t>(target)]);
  return std::min(1.0f, std::abs(cosine));
}

// Neighbouring samples have neighbouring nearest places: each starts from the last one's.
template <class Tree>
DirectedDistances measure(
    const SurfacePoints& samples,
    const Tree& tree,
    const std::vector<Vec3f>& target_normals,
    double max_distance
) {
  DirectedDistances result;
  const std::size_t count = samples.positions.size();
  result.distances.resize(count), result.normal_cosines.resize(count);
  parallel_for_blocks(count, kBlock, [&](std::size_t begin, std::size_t end) {
    std::int32_t guess = -1;
    for (std::size_t i = begin; i < end; ++i) {
      const Nearest nearest = tree.nearest(samples.positions[i], max_distance, guess);
      guess = nearest.id;
      result.distances[i] = nearest.distance;
      result.normal_cosines[i] = normal_cosine(samples.normals, i, target_normals, nearest.id);
    }
  });
  return result;
}

DirectedDistances measure_to_points(
    const SurfacePoints& samples, const SurfacePoints& target, double max_distance
) {
  return measure(samples, PointTree(target.positions), target.normals, max_distance);
}

double limit_of(double max_distance_m) {
  return max_distance_m > 0 ? max_distance_m : std::numeric_limits<double>::infinity();
}

SurfacePoints samples_of(const Surface& surface, const MeshProtocol& protocol, std::uint64_t seed) {
  return std::visit(
      [&](const auto& content) { return sample_surface(content, protocol.num_samples, seed); },
      surface
  );
}

}  // namespace

DirectedDistances distances_to(
    const SurfacePoints& from, const Surface& target, double max_distance_m
) {
  const double limit = limit_of(max_distance_m);
  if (const auto* points = std::get_if<SurfacePoints>(&target))
    return measure_to_points(from, *points, limit);
  const auto& mesh = std::get<TriangleMesh>(target);
  return measure(from, TriangleTree(mesh), face_normals(mesh), limit);
}

SurfaceDistances surface_distances(
    const Surface& prediction, const Surface& reference, const MeshProtocol& protocol
) {
  check_mesh_protocol(protocol);
  GLINT_CHECK(has_content(prediction), kBadPrediction, "the prediction has no faces or points");
  GLINT_CHECK(has_content(reference), kBadReference, "the reference has no faces or points");
  const SurfacePoints predicted = samples_of(prediction, protocol, protocol.seed);
  const SurfacePoints truth = samples_of(reference, protocol, protocol.seed ^ kReferenceStream);
  const double limit = protocol.max_distance_m;
  if (protocol.distance == SurfaceDistance::kPointToPoint)
    return {distances_to(predicted, truth, limit), distances_to(truth, predicted, limit)};
  return {distances_to(predicted, reference, limit), distances_to(truth, prediction, limit)};
}

}  // namespace glint
