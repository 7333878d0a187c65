// SPDX-License-Identifier: MIT
// How far mirrored rays go in training, and that pictures have all of them to the end.
#include "glint/train/mirrored_layer.h"

#include <catch2/catch.hpp>
#include <cstring>

#include "glint/core/rng.h"
#include "glint/render/spherical_harmonics.h"

using namespace glint;

namespace {

constexpr ImageSize kSize{24, 16};

// A fog of surfels in front of a wall that mirrors anything from little to nearly all. Their
// colours are at most 1.
TrainableSet fog(Rng& rng) {
  PointCloud points;
  for (int i = 0; i < 1500; ++i) {
    points.positions.push_back({rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.1f, 3)});
    points.colors.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
  }
  return TrainableSet(points, {}, {});
}

GlassBuffer wall(Rng& rng) {
  GlassBuffer b;
  b.depth = Image(kSize.width, kSize.height, 1, 2.0f);
  b.transparency = b.specularity = Image(kSize.width, kSize.height, 1);
  b.normal = b.reflected.origins = b.reflected.directions = Image(kSize.width, kSize.height, 3);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      b.specularity.at(x, y) = 0.5f * rng.uniform() * rng.uniform();
      b.normal.at(x, y, 2) = -1;
      b.reflected.origins.at(x, y, 0) = 0.05f * static_cast<float>(x - 12);
      b.reflected.origins.at(x, y, 1) = 0.05f * static_cast<float>(y - 8);
      b.reflected.directions.at(x, y, 2) = 1;
    }
  return b;
}

bool same_bytes(const Image& a, const Image& b) {
  return a.values().size() == b.values().size() &&
         std::memcmp(a.data(), b.data(), a.values().size() * sizeof(float)) == 0;
}

}  // namespace

TEST_CASE("A mirrored ray that ends early changes its pixel by less than mirror_weight_below") {
  Rng rng(1);
  TrainableSet set = fog(rng);
  const GlassBuffer buffer = wall(rng);
  MirrorCutoffs mirror;
  mirror.share_below = 0;
  mirror.picture_transmittance = mirror.transmittance;
  mirror.picture_hits = mirror.hits;
  MirroredLayer layer;
  Image all, cut, picture;
  layer.trace(buffer, set, 0, mirror, 3, all);
  mirror.weight_below = 0.02f;
  layer.trace(buffer, set, 0, mirror, 3, cut);
  layer.trace(buffer, set, 0, mirror, {}, picture);
  CHECK(same_bytes(all, picture));
  int differ = 0;
  float worst = 0;
  for (std::size_t i = 0; i < all.values().size(); ++i) {
    const float k_s = buffer.specularity.data()[i / 3], change = all.data()[i] - cut.data()[i];
    CHECK(change >= 0);
    differ += change > 0;
    worst = std::max(worst, k_s * change);
  }
  CHECK(differ > static_cast<int>(all.values().size()) / 4);
  CHECK(worst < mirror.weight_below);
  CHECK(worst > 0.2f * mirror.weight_below);  // it is used
}

TEST_CASE("Pictures have mirrored rays to the end, where training stops before") {
  Rng rng(4);
  TrainableSet set = fog(rng);
  const GlassBuffer buffer = wall(rng);
  MirrorCutoffs mirror;
  mirror.share_below = 0;
  MirroredLayer layer;
  Image training, picture, whole;
  layer.trace(buffer, set, 0, mirror, 3, training);
  layer.trace(buffer, set, 0, mirror, {}, picture);
  CHECK_FALSE(same_bytes(training, picture));
  mirror.transmittance = kMinTransmittance;
  mirror.hits = 256;
  layer.trace(buffer, set, 0, mirror, 3, whole);
  CHECK(same_bytes(whole, picture));
}

TEST_CASE("Mirrored rays without mirror_weight_below, and with one that is too small, are the same"
) {
  Rng rng(2);
  TrainableSet set = fog(rng);
  const GlassBuffer buffer = wall(rng);
  MirrorCutoffs mirror;
  Image all, small;
  MirroredLayer layer;
  layer.trace(buffer, set, 0, mirror, 5, all);
  mirror.weight_below = 1e-9f;
  layer.trace(buffer, set, 0, mirror, 5, small);
  CHECK(same_bytes(all, small));
}
