// SPDX-License-Identifier: MIT
#include "glint/render/surfel_cluster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "glint/core/parallel.h"

namespace glint {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kLanes = Float8::kLanes;

float reach(const SurfelFields<float>& s, int axis) {
  return std::sqrt(s.max_rho * (s.h0[axis] * s.h0[axis] + s.h1[axis] * s.h1[axis]));
}

bool is_finite(const float* mean) { return std::isfinite(mean[0] + mean[1] + mean[2]); }

// Neighbours [begin, end) of an order of surfels.
struct Range {
  std::size_t begin, end;
  std::size_t size() const { return end - begin; }
};

int widest_axis(std::span<const float> means, std::span<const std::uint32_t> order) {
  float low[3] = {kInfinity, kInfinity, kInfinity};
  float high[3] = {-kInfinity, -kInfinity, -kInfinity};
  for (const std::uint32_t i : order)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], means[3 * i + axis]);
      high[axis] = std::max(high[axis], means[3 * i + axis]);
    }
  int widest = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (high[axis] - low[axis] > high[widest] - low[widest]) widest = axis;
  return widest;
}

// Sorts the halves of a range apart along its widest axis, at a whole number of clusters.
std::size_t halve(std::span<const float> means, Range range, std::vector<std::uint32_t>& order) {
  const std::size_t num_clusters = (range.size() + kLanes - 1) / kLanes;
  const std::size_t middle = range.begin + (num_clusters + 1) / 2 * kLanes;
  const auto at = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
  const int axis = widest_axis(means, std::span(order).subspan(range.begin, range.size()));
  const auto place = [&](std::uint32_t i) {
    return std::pair(means[3 * i + static_cast<std::size_t>(axis)], i);
  };
  std::nth_element(
      at(range.begin),
      at(middle),
      at(range.end),
      [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); }
  );
  return middle;
}

}  // namespace

// Clusters are the leaves of a k-d tree: smaller boxes than pieces of a space-filling curve have,
// which also loses its resolution to surfels far away.
std::vector<std::uint32_t> cluster_slots(std::span<const float> means) {
  std::vector<std::uint32_t> order(means.size() / 3);
  std::iota(order.begin(), order.end(), 0u);
  const auto finite = std::stable_partition(order.begin(), order.end(), [&](std::uint32_t i) {
    return is_finite(&means[3 * i]);
  });
  std::vector<Range> ranges = {{0, static_cast<std::size_t>(finite - order.begin())}};
  // The first of the ranges is as large as any.
  for (std::vector<Range> halves; ranges.front().size() > kLanes; ranges.swap(halves)) {
    halves.resize(2 * ranges.size());
    parallel_for(ranges.size(), 1, [&](std::size_t i) {
      const Range range = ranges[i];
      const std::size_t middle = range.size() > kLanes ? halve(means, range, order) : range.end;
      halves[2 * i] = {range.begin, middle};
      halves[2 * i + 1] = {middle, range.end};
    });
  }
  std::vector<std::uint32_t> slots(order.size());
  for (std::size_t slot = 0; slot < order.size(); ++slot)
    slots[order[slot]] = static_cast<std::uint32_t>(slot);
  return slots;
}

void make_clusters(const std::vector<TracedSurfel>& surfels, std::vector<SurfelCluster>& clusters) {
  clusters.resize((surfels.size() + kLanes - 1) / kLanes);
  parallel_for(clusters.size(), 256, [&](std::size_t i) {
    TracedSurfel nowhere{};
    nowhere.fields.max_rho = -1;
    const float* rows[kLanes];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t slot = kLanes * i + lane;
      const TracedSurfel& s = slot < surfels.size() ? surfels[slot] : nowhere;
      rows[lane] = s.floats();
      clusters[i].surfel[lane] = s.surfel;
    }
    RowLanes columns;
    load_columns(rows, columns);
    std::copy_n(columns, SurfelCluster::kFields, clusters[i].fields);
  });
}

ClusterBox box_of_cluster(const std::vector<TracedSurfel>& surfels, std::size_t cluster) {
  ClusterBox box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  const std::size_t begin = kLanes * cluster;
  for (std::size_t i = begin; i < std::min(begin + kLanes, surfels.size()); ++i) {
    const SurfelFields<float>& s = surfels[i].fields;
    if (!(s.max_rho > 0)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const float half =
          reach(s, axis) * (1 + kBoxMargin) + kBoxMargin * std::abs(s.mean[axis]) * 0.01f;
      box.low[axis] = std::min(box.low[axis], s.mean[axis] - half);
      box.high[axis] = std::max(box.high[axis], s.mean[axis] + half);
    }
  }
  return box;
}

}  // namespace glint
