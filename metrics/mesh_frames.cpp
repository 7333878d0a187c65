// SPDX-License-Identifier: MIT
#include "metrics/mesh_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/middle.h"
#include "metrics/length_units.h"

namespace glint {
namespace {

bool is_finite(Vec3f v) { return std::isfinite(v.x + v.y + v.z); }

double extent_of(std::span<const Vec3f> corners) {
  std::vector<Vec3d> places;
  for (const Vec3f corner : corners)
    if (is_finite(corner)) places.push_back(cast<double>(corner));
  return spread_of(places);
}

struct Bounds {
  Vec3f low, high;
};

template <class Turn>
Bounds bounds_of(std::span<const Vec3f> corners, Turn&& turn) {
  constexpr float kFar = std::numeric_limits<float>::max();
  Bounds bounds{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (const Vec3f corner : corners)
    for (int c = 0; is_finite(corner) && c < 3; ++c) {
      bounds.low[c] = std::min(bounds.low[c], turn(corner)[c]);
      bounds.high[c] = std::max(bounds.high[c], turn(corner)[c]);
    }
  return bounds;
}

// Shared volume over that of either.
double overlap(const Bounds& a, const Bounds& b) {
  double shared = 1, of_a = 1, of_b = 1;
  for (int c = 0; c < 3; ++c) {
    const float low = std::max(a.low[c], b.low[c]), high = std::min(a.high[c], b.high[c]);
    shared *= static_cast<double>(std::max(0.0f, high - low));
    of_a *= static_cast<double>(a.high[c] - a.low[c]);
    of_b *= static_cast<double>(b.high[c] - b.low[c]);
  }
  const double either = of_a + of_b - shared;
  return either > 0 ? shared / either : 0;
}

}  // namespace

std::string mesh_unit_doubt(const NamedCorners& prediction, const NamedCorners& reference) {
  const double found = extent_of(prediction.corners), expected = extent_of(reference.corners);
  if (!(found > 0 && expected > 0) || !is_odd_length_ratio(found / expected)) return {};
  return fmt::format(
      "{} is {:.3g} times as large as {} (by the median distance from its middle) and is scored as "
      "metres; is it in {}?",
      prediction.path.string(),
      found / expected,
      reference.path.string(),
      likely_unit(found / expected)
  );
}

std::string gltf_up_doubt(const NamedCorners& mesh, const NamedCorners& other, GltfUp up) {
  constexpr double kFarBetter = 2, kLikely = 0.3;
  if (!is_gltf(mesh.path) || up == GltfUp::kZ) return {};
  const auto as_it_is = [](Vec3f v) { return v; };
  const Bounds target = bounds_of(other.corners, as_it_is);
  const double stored = overlap(bounds_of(mesh.corners, as_it_is), target),
               turned = overlap(bounds_of(mesh.corners, turned_back), target);
  if (turned < kLikely || turned < kFarBetter * stored) return {};
  return fmt::format(
      "{}: glTF has y up, and its box shares {:.0f} % with that of {} as stored, {:.0f} % turned "
      "back to z up: was it exported from a frame with z up, as by Blender? give --gltf-up z",
      mesh.path.string(),
      100 * stored,
      other.path.string(),
      100 * turned
  );
}

}  // namespace glint
