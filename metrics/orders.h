// SPDX-License-Identifier: MIT
// Orders of points across the surfaces along rays, as LayeredDepth scores them (Wen et al., ICCV
// 2025, arXiv 2503.11633): the share of pairs, triplets and quadruplets of points whose predicted
// depths are in their true order. No scale and no shift changes it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "glint/core/image.h"

namespace glint {

struct LayerPoint {
  int x = 0, y = 0;  // pixel
  int layer = 1;     // which surface along its ray, the nearest first
};
using LayerTuple = std::vector<LayerPoint>;  // from the nearest to the farthest

// A predicted depth, positive; none: the method has no such surface there.
using DepthAt = std::function<std::optional<float>(LayerPoint)>;

// Is each point strictly behind the one in front? A point without a depth is in no order.
bool in_order(const LayerTuple& tuple, const DepthAt& depth);

// Percent of tuples that are; none: there is no tuple.
std::optional<double> percent_in_order(std::span<const LayerTuple> tuples, const DepthAt& depth);

struct OrderProtocol {
  int draws = 4000;      // of each size
  double margin = 0.05;  // relative: a point counts as behind another by so much at least
};

// Tuples of `size` points of true surfaces (metres, [H][W][1] each, nearest first; 0 or not finite:
// none there), of pixels that have more than one and count. Draws are numbers of a linear
// congruential generator (Knuth's MMIX, from 0), so that any language can repeat them; draws with
// points that the margin does not part are left out.
std::vector<LayerTuple> draw_tuples(
    std::span<const ImageView> surfaces, MaskView counted, int size, const OrderProtocol& protocol
);

}  // namespace glint
