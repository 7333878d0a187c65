// SPDX-License-Identifier: MIT
#include "datasets/front3d/floor_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "glint/core/error.h"

namespace glint {

namespace {

constexpr float kWidest = 60;  // metres

// Twice the signed area of a, b, p.
float side_of(Vec3f a, Vec3f b, Vec2f p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

// Squared distances, in cells, along one line [Felzenszwalb12]: the lower envelope of parabolas.
void transform_line(std::vector<double>& f) {
  const int n = static_cast<int>(f.size());
  std::vector<int> at(f.size());
  std::vector<double> from(f.size() + 1), out(f.size());
  const auto value = [&](int i) { return f[static_cast<std::size_t>(i)]; };
  const auto meet = [&](int p, int q) {  // where the parabola of q begins to be below that of p
    return (value(q) - value(p) + static_cast<double>(q) * q - static_cast<double>(p) * p) /
           (2.0 * (q - p));
  };
  std::size_t k = 0;
  from[0] = -std::numeric_limits<double>::infinity();
  from[1] = -from[0];
  for (int q = 1; q < n; ++q) {
    double x = meet(at[k], q);
    while (k > 0 && x <= from[k]) x = meet(at[--k], q);
    at[++k] = q;
    from[k] = x;
    from[k + 1] = std::numeric_limits<double>::infinity();
  }
  k = 0;
  for (int q = 0; q < n; ++q) {
    while (from[k + 1] < q) ++k;
    const double d = q - at[k];
    out[static_cast<std::size_t>(q)] = d * d + value(at[k]);
  }
  f = std::move(out);
}

// Cells from one distance to another along an axis, first and last; of `count`.
struct Range {
  int first, last;
};
Range cells(float low, float high, int count) {
  const auto cell = [&](float at) {
    return static_cast<int>(std::clamp(at / FloorPlan::kCell, 0.0f, static_cast<float>(count - 1)));
  };
  return {cell(low), cell(high)};
}

using Corner = std::pair<long, long>;  // millimetres
Corner corner_of(Vec3f p) {
  return {
      std::lround(1000 * static_cast<double>(p.x)), std::lround(1000 * static_cast<double>(p.y))};
}

// The edge a-b in pieces, cut where other corners of the floor lie on it: triangles of two meshes
// need not share their corners.
std::vector<Corner> cut_edge(Corner a, Corner b, const std::set<Corner>& corners) {
  constexpr double kOn = 2;  // millimetres
  const double x = static_cast<double>(b.first - a.first),
               y = static_cast<double>(b.second - a.second), length = std::hypot(x, y);
  std::vector<std::pair<double, Corner>> along{{0, a}, {length, b}};
  for (const Corner& corner : corners) {
    const double dx = static_cast<double>(corner.first - a.first),
                 dy = static_cast<double>(corner.second - a.second);
    const double at = (dx * x + dy * y) / length, off = (dx * y - dy * x) / length;
    if (at > kOn && at < length - kOn && std::abs(off) <= kOn) along.emplace_back(at, corner);
  }
  std::sort(along.begin(), along.end());
  std::vector<Corner> pieces;
  for (const auto& [at, corner] : along) pieces.push_back(corner);
  return pieces;
}

}  // namespace

FloorPlan::FloorPlan(const std::vector<TraceMesh>& floors, const std::string& where) {
  for (const TraceMesh& mesh : floors)
    for (const Vec3f vertex : mesh.vertices) bounds_.include(vertex);
  const Vec3f size = bounds_.size();
  GLINT_CHECK(
      size.x <= kWidest && size.y <= kWidest,
      kBadReference,
      "{}: its floor is {} x {} m, expected at most {} m; choose another room",
      where,
      size.x,
      size.y,
      kWidest
  );
  width_ = std::max(1, static_cast<int>(std::ceil(size.x / kCell)));
  height_ = std::max(1, static_cast<int>(std::ceil(size.y / kCell)));
  floor_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
  for (const TraceMesh& mesh : floors)
    for (const auto& face : mesh.faces) {
      const auto at = [&](std::size_t k) {
        return mesh.vertices[static_cast<std::size_t>(face[k])];
      };
      fill(at(0), at(1), at(2));
    }
  GLINT_CHECK(
      std::any_of(floor_.begin(), floor_.end(), [](unsigned char cell) { return cell != 0; }),
      kBadReference,
      "{}: its floor covers nothing; choose another room",
      where
  );
  free_ = floor_;
  find_sides(floors);
}

std::size_t FloorPlan::index(int x, int y) const {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
         static_cast<std::size_t>(x);
}

Vec2f FloorPlan::center_of(int x, int y) const {
  return {
      bounds_.low.x + (static_cast<float>(x) + 0.5f) * kCell,
      bounds_.low.y + (static_cast<float>(y) + 0.5f) * kCell};
}

void FloorPlan::fill(Vec3f a, Vec3f b, Vec3f c) {
  Bounds box;
  for (const Vec3f p : {a, b, c}) box.include(p);
  const Range rows = cells(box.low.y - bounds_.low.y, box.high.y - bounds_.low.y, height_);
  const Range columns = cells(box.low.x - bounds_.low.x, box.high.x - bounds_.low.x, width_);
  for (int y = rows.first; y <= rows.last; ++y)
    for (int x = columns.first; x <= columns.last; ++x) {
      const Vec2f p = center_of(x, y);
      const float ab = side_of(a, b, p), bc = side_of(b, c, p), ca = side_of(c, a, p);
      const bool inside = (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
      if (inside) floor_[index(x, y)] = 1;
    }
}

bool FloorPlan::is_floor(Vec2f p) const {
  const float x = std::floor((p.x - bounds_.low.x) / kCell);
  const float y = std::floor((p.y - bounds_.low.y) / kCell);
  const bool inside =
      x >= 0 && y >= 0 && x < static_cast<float>(width_) && y < static_cast<float>(height_);
  return inside && floor_[index(static_cast<int>(x), static_cast<int>(y))] != 0;
}

void FloorPlan::block(const Bounds& local, const Pose& pose, float margin) {
  const Bounds footprint = local.grown(margin);
  const float reach = 0.5f * std::hypot(footprint.size().x, footprint.size().y);
  const Vec3f middle = pose.apply(footprint.center());
  const Range rows =
      cells(middle.y - reach - bounds_.low.y, middle.y + reach - bounds_.low.y, height_);
  const Range columns =
      cells(middle.x - reach - bounds_.low.x, middle.x + reach - bounds_.low.x, width_);
  for (int y = rows.first; y <= rows.last; ++y)
    for (int x = columns.first; x <= columns.last; ++x) {
      const Vec2f p = center_of(x, y);
      // Furniture stands upright: any height gives the same two coordinates.
      const Vec3f at = transpose_times(
          pose.rotation, Vec3f{p.x - pose.translation.x, p.y - pose.translation.y, 0}
      );
      if (at.x >= footprint.low.x && at.x <= footprint.high.x && at.y >= footprint.low.y &&
          at.y <= footprint.high.y)
        free_[index(x, y)] = 0;
    }
}

std::vector<FloorPlan::Spot> FloorPlan::free_spots() const {
  constexpr double kFar = 1e12;
  // With a rim of cells that are no floor.
  const int w = width_ + 2, h = height_ + 2;
  std::vector<std::vector<double>> rows(
      static_cast<std::size_t>(h), std::vector<double>(static_cast<std::size_t>(w), 0)
  );
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      if (free_[index(x, y)] != 0)
        rows[static_cast<std::size_t>(y + 1)][static_cast<std::size_t>(x + 1)] = kFar;
  for (auto& row : rows) transform_line(row);
  std::vector<double> column(static_cast<std::size_t>(h));
  std::vector<Spot> spots;
  for (std::size_t x = 0; x < static_cast<std::size_t>(w); ++x) {
    for (std::size_t y = 0; y < column.size(); ++y) column[y] = rows[y][x];
    transform_line(column);
    for (std::size_t y = 0; y < column.size(); ++y) rows[y][x] = column[y];
  }
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const double d2 = rows[static_cast<std::size_t>(y + 1)][static_cast<std::size_t>(x + 1)];
      if (d2 > 0)  // from its centre to the other cell's rim
        spots.push_back({center_of(x, y), static_cast<float>(std::sqrt(d2) - 0.5) * kCell});
    }
  return spots;
}

void FloorPlan::find_sides(const std::vector<TraceMesh>& floors) {
  std::set<Corner> corners;
  for (const TraceMesh& mesh : floors)
    for (const Vec3f vertex : mesh.vertices) corners.insert(corner_of(vertex));
  std::map<std::pair<Corner, Corner>, int> edges;
  for (const TraceMesh& mesh : floors)
    for (const auto& face : mesh.faces)
      for (std::size_t k = 0; k < 3; ++k) {
        const Corner a = corner_of(mesh.vertices[static_cast<std::size_t>(face[k])]);
        const Corner b = corner_of(mesh.vertices[static_cast<std::size_t>(face[(k + 1) % 3])]);
        if (a == b) continue;
        const std::vector<Corner> pieces = cut_edge(a, b, corners);
        for (std::size_t i = 0; i + 1 < pieces.size(); ++i)
          ++edges[std::minmax(pieces[i], pieces[i + 1])];
      }
  for (const auto& [edge, count] : edges)
    if (count == 1) add_side(edge.first, edge.second);
}

void FloorPlan::add_side(std::pair<long, long> from, std::pair<long, long> to) {
  const auto metres = [](Corner c) {
    return Vec3f{0.001f * static_cast<float>(c.first), 0.001f * static_cast<float>(c.second), 0};
  };
  const Vec3f start = metres(from), step = metres(to) - start;
  const Vec3f along = normalize(step), middle = start + 0.5f * step;
  const Vec2f right{along.y, -along.x};
  const bool is_inward = is_floor(Vec2f{middle.x, middle.y} + 1.5f * kCell * right);
  sides_.push_back(
      {{start.x, start.y}, {along.x, along.y}, (is_inward ? -1.0f : 1.0f) * right, length(step)}
  );
}

}  // namespace glint
