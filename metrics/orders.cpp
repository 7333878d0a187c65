// SPDX-License-Identifier: MIT
#include "metrics/orders.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

bool is_depth(float z) { return std::isfinite(z) && z > 0; }

bool has_surface(std::span<const ImageView> surfaces, std::size_t layer, std::size_t pixel) {
  return layer < surfaces.size() && !surfaces[layer].empty() &&
         is_depth(surfaces[layer].data[pixel]);
}

class Draws {
 public:
  std::size_t below(std::size_t n) {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<std::size_t>(state_ >> 33u) % n;
  }

 private:
  std::uint64_t state_ = 0;
};

// Layer by layer, each row by row.
std::vector<LayerPoint> points_of(std::span<const ImageView> surfaces, MaskView counted) {
  std::vector<LayerPoint> points;
  for (std::size_t layer = 0; layer < surfaces.size(); ++layer)
    for (std::size_t i = 0; i < surfaces.front().num_pixels(); ++i)
      if (has_surface(surfaces, layer, i) && has_surface(surfaces, 1, i) &&
          (counted.empty() || counted.data[i] != 0)) {
        const int width = surfaces.front().width, pixel = static_cast<int>(i);
        points.push_back({pixel % width, pixel / width, static_cast<int>(layer) + 1});
      }
  return points;
}

}  // namespace

bool in_order(const LayerTuple& tuple, const DepthAt& depth) {
  float last = 0;
  for (const LayerPoint point : tuple) {
    const std::optional<float> z = depth(point);
    if (!z || !is_depth(*z) || *z <= last) return false;
    last = *z;
  }
  return true;
}

std::optional<double> percent_in_order(std::span<const LayerTuple> tuples, const DepthAt& depth) {
  if (tuples.empty()) return std::nullopt;
  const auto right = std::ranges::count_if(tuples, [&](const LayerTuple& tuple) {
    return in_order(tuple, depth);
  });
  return 100.0 * static_cast<double>(right) / static_cast<double>(tuples.size());
}

std::vector<LayerTuple> draw_tuples(
    std::span<const ImageView> surfaces, MaskView counted, int size, const OrderProtocol& protocol
) {
  const std::vector<LayerPoint> points = points_of(surfaces, counted);
  std::vector<LayerTuple> tuples;
  if (points.empty()) return tuples;
  const auto true_depth = [&](LayerPoint p) {
    return static_cast<double>(surfaces[static_cast<std::size_t>(p.layer - 1)].at(p.x, p.y));
  };
  Draws draws;
  for (int i = 0; i < protocol.draws; ++i) {
    LayerTuple tuple;
    for (int k = 0; k < size; ++k) tuple.push_back(points[draws.below(points.size())]);
    std::ranges::stable_sort(tuple, {}, true_depth);
    const auto too_near = [&](LayerPoint a, LayerPoint b) {
      return true_depth(b) < (1 + protocol.margin) * true_depth(a);
    };
    if (std::ranges::adjacent_find(tuple, too_near) == tuple.end())
      tuples.push_back(std::move(tuple));
  }
  return tuples;
}

}  // namespace glint
