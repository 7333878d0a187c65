// SPDX-License-Identifier: MIT
#include "metrics/mesh/samples.h"

#include <algorithm>
#include <cmath>

#include "glint/core/parallel.h"
#include "glint/core/rng.h"
#include "metrics/mesh/triangle.h"

namespace glint {
namespace {

constexpr std::size_t kBlock = 4096;  // samples of one random sequence

// Entry i: the area of the faces 0..i.
std::vector<double> cumulative_areas(const TriangleMesh& mesh) {
  std::vector<double> ends(mesh.faces.size());
  double total = 0;
  for (std::size_t i = 0; i < ends.size(); ++i)
    ends[i] = total += 0.5 * length(area_vector(corners_of(mesh, i)));
  return ends;
}

double draw(Rng& rng) { return static_cast<double>(rng.uniform()); }

Vec3f uniform_point(const Corners& corners, Rng& rng) {
  const double root = std::sqrt(draw(rng)), second = draw(rng);
  const Vec3d point =
      (1 - root) * corners[0] + root * (1 - second) * corners[1] + root * second * corners[2];
  return cast<float>(point);
}

}  // namespace

double surface_area(const TriangleMesh& mesh) {
  return mesh.faces.empty() ? 0 : cumulative_areas(mesh).back();
}

std::vector<Vec3f> face_normals(const TriangleMesh& mesh) {
  std::vector<Vec3f> normals(mesh.faces.size());
  parallel_for(normals.size(), kBlock, [&](std::size_t i) {
    normals[i] = cast<float>(normalize(area_vector(corners_of(mesh, i))));
  });
  return normals;
}

SurfacePoints sample_surface(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
  const std::vector<double> ends = cumulative_areas(mesh);
  const std::vector<Vec3f> normals = face_normals(mesh);
  const double step = ends.back() / static_cast<double>(count);
  SurfacePoints samples;
  samples.positions.resize(count), samples.normals.resize(count);
  parallel_for_blocks(count, kBlock, [&](std::size_t begin, std::size_t end) {
    Rng rng(seed, begin / kBlock);
    const auto first =
        std::upper_bound(ends.begin(), ends.end(), step * static_cast<double>(begin));
    std::size_t face = std::min<std::size_t>(first - ends.begin(), ends.size() - 1);
    for (std::size_t i = begin; i < end; ++i) {
      const double place = step * (static_cast<double>(i) + draw(rng));
      while (face + 1 < ends.size() && ends[face] <= place) ++face;
      samples.positions[i] = uniform_point(corners_of(mesh, face), rng);
      samples.normals[i] = normals[face];
    }
  });
  return samples;
}

// Selection sampling: each point is taken with probability (wanted left) / (points left).
SurfacePoints sample_surface(const SurfacePoints& points, std::size_t count, std::uint64_t seed) {
  if (points.positions.size() <= count) return points;
  SurfacePoints samples;
  Rng rng(seed);
  std::size_t left = points.positions.size();
  for (std::size_t i = 0; samples.positions.size() < count; ++i, --left) {
    if (rng.below(static_cast<std::uint32_t>(left)) >= count - samples.positions.size()) continue;
    samples.positions.push_back(points.positions[i]);
    if (!points.normals.empty()) samples.normals.push_back(points.normals[i]);
  }
  return samples;
}

}  // namespace glint
