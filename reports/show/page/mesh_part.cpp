// SPDX-License-Identifier: MIT
#include "reports/show/page/mesh_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "reports/run/records/script_text.h"

namespace glint {

namespace {

using Cell = std::array<std::int64_t, 3>;

struct Box {
  std::array<float, 3> low{}, high{};
  float longest() const {
    float side = 0;
    for (std::size_t i = 0; i < 3; ++i) side = std::max(side, high[i] - low[i]);
    return side;
  }
};

std::array<float, 3> components(Vec3f v) { return {v.x, v.y, v.z}; }

Box box_of(const TriangleMesh& mesh) {
  Box box;
  if (!mesh.vertices.empty()) box.low = box.high = components(mesh.vertices.front());
  for (const Vec3f& vertex : mesh.vertices)
    for (std::size_t i = 0; i < 3; ++i) {
      box.low[i] = std::min(box.low[i], components(vertex)[i]);
      box.high[i] = std::max(box.high[i], components(vertex)[i]);
    }
  return box;
}

Cell cell_of(Vec3f vertex, float cell) {
  Cell at{};
  for (std::size_t i = 0; i < 3; ++i)
    at[i] = static_cast<std::int64_t>(std::floor(components(vertex)[i] / cell));
  return at;
}

// Of each vertex the first one of its cell. Sorted, not looked up: what a map or a table keeps lies
// all over the memory.
std::vector<std::int32_t> first_of_cell(const TriangleMesh& mesh, float cell) {
  std::vector<std::pair<Cell, std::int32_t>> places;
  places.reserve(mesh.vertices.size());
  for (const Vec3f& vertex : mesh.vertices)
    places.emplace_back(cell_of(vertex, cell), static_cast<std::int32_t>(places.size()));
  std::sort(places.begin(), places.end());
  std::vector<std::int32_t> first(places.size());
  const std::pair<Cell, std::int32_t>* head = nullptr;
  for (const auto& place : places) {
    if (head == nullptr || head->first != place.first) head = &place;
    first[static_cast<std::size_t>(place.second)] = head->second;
  }
  return first;
}

std::vector<std::uint8_t> position_codes(const TriangleMesh& mesh, const Box& box) {
  const std::size_t count = 3 * mesh.vertices.size();
  std::vector<std::uint8_t> codes(2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t axis = i % 3;
    const float side = std::max(box.high[axis] - box.low[axis], 1e-12f);
    const float share = (components(mesh.vertices[i / 3])[axis] - box.low[axis]) / side;
    const long code = std::lround(std::clamp(share, 0.0f, 1.0f) * 65535);
    codes[i] = static_cast<std::uint8_t>(code & 255);
    codes[count + i] = static_cast<std::uint8_t>(code >> 8);
  }
  return codes;
}

std::vector<std::uint8_t> index_bytes(const TriangleMesh& mesh) {
  std::vector<std::uint8_t> bytes;
  for (const auto& face : mesh.faces)
    for (const std::int32_t index : face)
      for (int shift = 0; shift < 32; shift += 8)
        bytes.push_back(static_cast<std::uint8_t>(index >> shift & 255));
  return bytes;
}

Json color_codes(const TriangleMesh& mesh) {
  if (mesh.colors.size() != mesh.vertices.size()) return nullptr;
  std::vector<std::uint8_t> codes;
  for (const Vec3f& color : mesh.colors)
    for (const float value : components(color))
      codes.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255)));
  return packed(codes);
}

}  // namespace

TriangleMesh merge_vertices(const TriangleMesh& mesh, float cell) {
  const std::vector<std::int32_t> first = first_of_cell(mesh, cell);
  std::vector<std::int32_t> merged(mesh.vertices.size());
  std::vector<float> counts;
  TriangleMesh coarse;
  const bool colored = mesh.colors.size() == mesh.vertices.size();
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto leader = static_cast<std::size_t>(first[i]);
    merged[i] = leader == i ? static_cast<std::int32_t>(counts.size()) : merged[leader];
    const auto at = static_cast<std::size_t>(merged[i]);
    if (leader == i) {
      coarse.vertices.emplace_back();
      if (colored) coarse.colors.emplace_back();
      counts.push_back(0);
    }
    coarse.vertices[at] = coarse.vertices[at] + mesh.vertices[i];
    if (colored) coarse.colors[at] = coarse.colors[at] + mesh.colors[i];
    ++counts[at];
  }
  for (std::size_t i = 0; i < counts.size(); ++i) {
    coarse.vertices[i] = (1 / counts[i]) * coarse.vertices[i];
    if (colored) coarse.colors[i] = (1 / counts[i]) * coarse.colors[i];
  }
  for (const auto& face : mesh.faces) {
    std::array<std::int32_t, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) corners[i] = merged[static_cast<std::size_t>(face[i])];
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
      coarse.faces.push_back(corners);
  }
  return coarse;
}

TriangleMesh with_few_faces(const TriangleMesh& mesh, std::size_t max_faces) {
  TriangleMesh coarse = mesh;
  float cell = box_of(mesh).longest() / 1024;
  while (coarse.faces.size() > max_faces && cell > 0) {
    coarse = merge_vertices(mesh, cell);
    // Faces of a surface go with 1 / cell^2; a little less than that, so as not to lose too many.
    const double excess = static_cast<double>(coarse.faces.size()) /
                          static_cast<double>(std::max<std::size_t>(max_faces, 1));
    cell *= std::max(1.1f, static_cast<float>(0.9 * std::sqrt(excess)));
  }
  return coarse;
}

Json mesh_json(const TriangleMesh& mesh) {
  const Box box = box_of(mesh);
  return {
      {"vertices", mesh.vertices.size()},
      {"faces", mesh.faces.size()},
      {"low", box.low},
      {"high", box.high},
      {"position", packed(position_codes(mesh, box))},
      {"index", packed(index_bytes(mesh))},
      {"color", color_codes(mesh)}};
}

}  // namespace glint
