// SPDX-License-Identifier: MIT
#include "metrics/mesh/clean.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "glint/core/parallel.h"
#include "metrics/mesh/triangle.h"

namespace glint {
namespace {

constexpr double kLeastHeight = 1e-7;  // over the longest edge; float resolves 6e-8
constexpr std::size_t kGrain = 4096;

bool is_finite(Vec3f v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

bool has_finite_corners(const TriangleMesh& mesh, const Triangle& face) {
  return std::all_of(face.begin(), face.end(), [&](std::int32_t id) {
    return is_finite(mesh.vertices[static_cast<std::size_t>(id)]);
  });
}

// Height times longest edge is twice the area.
bool is_flat(const Corners& corners) {
  double longest2 = 0;
  for (std::size_t i = 0; i < 3; ++i)
    longest2 = std::max(longest2, length2(corners[(i + 1) % 3] - corners[i]));
  return !(length(area_vector(corners)) > kLeastHeight * longest2);
}

// For each vertex the first one at its position; those that are not finite stand for themselves.
std::vector<std::int32_t> merge_positions(const std::vector<Vec3f>& vertices) {
  std::vector<std::int32_t> order, first(vertices.size());
  std::iota(first.begin(), first.end(), 0);
  for (const std::int32_t id : first)
    if (is_finite(vertices[static_cast<std::size_t>(id)])) order.push_back(id);
  const auto key = [&](std::int32_t id) {
    const Vec3f& v = vertices[static_cast<std::size_t>(id)];
    return std::tie(v.x, v.y, v.z);
  };
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return key(a) == key(b) ? a < b : key(a) < key(b);
  });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (key(order[i]) == key(order[i - 1]))
      first[static_cast<std::size_t>(order[i])] = first[static_cast<std::size_t>(order[i - 1])];
  return first;
}

Triangle merged(const Triangle& face, const std::vector<std::int32_t>& first) {
  Triangle corners;
  for (std::size_t k = 0; k < 3; ++k) corners[k] = first[static_cast<std::size_t>(face[k])];
  return corners;
}

// Clears the entries of kept faces whose corners an earlier one has; returns how many.
std::size_t drop_duplicates(
    const TriangleMesh& mesh,
    const std::vector<std::int32_t>& first,
    std::vector<std::uint8_t>& keep
) {
  std::vector<std::pair<Triangle, std::size_t>> keyed;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    if (!keep[i]) continue;
    Triangle corners = merged(mesh.faces[i], first);
    std::sort(corners.begin(), corners.end());
    keyed.emplace_back(corners, i);
  }
  std::sort(keyed.begin(), keyed.end());
  std::size_t dropped = 0;
  for (std::size_t i = 1; i < keyed.size(); ++i)
    if (keyed[i].first == keyed[i - 1].first) keep[keyed[i].second] = 0, ++dropped;
  return dropped;
}

std::size_t count_non_manifold_edges(
    const TriangleMesh& mesh,
    const std::vector<std::int32_t>& first,
    const std::vector<std::uint8_t>& keep
) {
  std::vector<std::uint64_t> edges;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    if (!keep[i]) continue;
    const Triangle corners = merged(mesh.faces[i], first);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(corners[k], corners[(k + 1) % 3]);
      edges.push_back(static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high));
    }
  }
  std::sort(edges.begin(), edges.end());
  std::size_t count = 0;
  for (auto begin = edges.begin(); begin != edges.end();) {
    const auto end = std::upper_bound(begin, edges.end(), *begin);
    count += end - begin > 2;
    begin = end;
  }
  return count;
}

}  // namespace

TriangleMesh select_faces(const TriangleMesh& mesh, std::span<const std::uint8_t> keep) {
  TriangleMesh selected;
  std::vector<std::int32_t> new_ids(mesh.vertices.size(), -1);
  const auto new_id = [&](std::int32_t id) {
    std::int32_t& to = new_ids[static_cast<std::size_t>(id)];
    if (to >= 0) return to;
    to = static_cast<std::int32_t>(selected.vertices.size());
    selected.vertices.push_back(mesh.vertices[static_cast<std::size_t>(id)]);
    if (!mesh.colors.empty()) selected.colors.push_back(mesh.colors[static_cast<std::size_t>(id)]);
    return to;
  };
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    if (!keep[i]) continue;
    const Triangle& face = mesh.faces[i];
    const std::int32_t a = new_id(face[0]), b = new_id(face[1]), c = new_id(face[2]);
    selected.faces.push_back({a, b, c});
  }
  return selected;
}

CleanMesh clean_mesh(const TriangleMesh& mesh) {
  CleanReport report;
  report.faces_before = mesh.faces.size();
  std::vector<std::uint8_t> finite(mesh.faces.size()), keep(mesh.faces.size());
  parallel_for(mesh.faces.size(), kGrain, [&](std::size_t i) {
    finite[i] = has_finite_corners(mesh, mesh.faces[i]);
    keep[i] = finite[i] && !is_flat(corners_of(mesh, i));
  });
  const auto count = [](const std::vector<std::uint8_t>& flags) {
    return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
  };
  report.not_finite = mesh.faces.size() - count(finite);
  report.zero_area = count(finite) - count(keep);
  const std::vector<std::int32_t> first = merge_positions(mesh.vertices);
  report.duplicate = drop_duplicates(mesh, first, keep);
  report.non_manifold_edges = count_non_manifold_edges(mesh, first, keep);
  report.faces_after = count(keep);
  return {select_faces(mesh, keep), report};
}

}  // namespace glint
