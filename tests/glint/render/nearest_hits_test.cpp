// SPDX-License-Identifier: MIT
// The list of a ray's nearest hits against sorting all of them.
#include "glint/render/nearest_hits.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <vector>

#include "glint/core/rng.h"

using namespace glint;

namespace {

// Surfels in slot order: whole groups of eight, numbered backwards, with t of few values, so that
// many coincide.
std::vector<FoundHit> random_hits(std::uint32_t groups, int values, float alpha, Rng& rng) {
  std::vector<FoundHit> hits;
  for (std::uint32_t slot = 0; slot < 8 * groups; ++slot) {
    const float t = 0.25f * static_cast<float>(1 + rng.below(static_cast<unsigned>(values)));
    hits.push_back({t, 8 * groups - slot, slot, alpha * rng.uniform(0.5f, 1)});
  }
  return hits;
}

// Offers every group, in an order that no search would choose.
void offer_all(const std::vector<FoundHit>& hits, Rng& rng, NearestHits& nearest) {
  std::vector<std::size_t> groups(hits.size() / 8);
  std::iota(groups.begin(), groups.end(), std::size_t{0});
  for (std::size_t i = groups.size(); i > 1; --i)
    std::swap(groups[i - 1], groups[rng.below(static_cast<std::uint32_t>(i))]);
  for (const std::size_t group : groups) {
    float t[8], alpha[8];
    Mask8::Lanes surfels, slots;
    for (std::size_t i = 0; i < 8; ++i) {
      t[i] = hits[8 * group + i].t;
      alpha[i] = hits[8 * group + i].alpha;
      surfels[i] = static_cast<std::int32_t>(hits[8 * group + i].surfel);
      slots[i] = static_cast<std::int32_t>(8 * group + i);
    }
    const Float8 ts = Float8::load(t);
    const Mask8 met = (ts >= Float8(nearest.after_t())) & (ts <= Float8(nearest.last_t()));
    nearest.add(ts, Float8::load(alpha), met, surfels, slots);
  }
}

std::vector<FoundHit> sorted(std::vector<FoundHit> hits, float near, float min_alpha) {
  const auto drops = [&](const FoundHit& hit) { return hit.t <= near || hit.alpha < min_alpha; };
  hits.erase(std::remove_if(hits.begin(), hits.end(), drops), hits.end());
  std::sort(hits.begin(), hits.end());
  return hits;
}

bool same(const FoundHit& a, const FoundHit& b) {
  return a == b && a.slot == b.slot && a.alpha == b.alpha;
}

}  // namespace

TEST_CASE("searches one after another return every hit once, in the order of t and surfel") {
  for (const std::uint32_t groups : {0u, 1u, 5u, 40u, 120u})
    for (const int values : {1, 7, 100000}) {
      INFO(groups << " groups, " << values << " values of t");
      Rng rng(groups + 1);
      const std::vector<FoundHit> hits = random_hits(groups, values, 0.02f, rng);
      const float near = values == 1 ? 0.0f : 0.25f;
      const std::vector<FoundHit> expected = sorted(hits, near, 0.012f);
      NearestHits nearest(near, 0.012f, 0);
      std::vector<FoundHit> found;
      for (bool more = true; more;) {
        nearest.start(1);
        offer_all(hits, rng, nearest);
        more = nearest.finish();
        for (int i = 0; i < nearest.count(); ++i) found.push_back(nearest[i]);
      }
      CHECK(std::equal(found.begin(), found.end(), expected.begin(), expected.end(), same));
    }
}

TEST_CASE("no hit is lost in front of the one that stops the ray, and few are kept behind it") {
  for (const float left : {1.0f, 0.01f}) {
    Rng rng(3);
    const std::vector<FoundHit> hits = random_hits(100, 100000, 0.5f, rng);
    const std::vector<FoundHit> expected = sorted(hits, 0, 0);
    constexpr float kMinTransmittance = 1e-3f;
    int until_stop = 0;
    for (float transmittance = left; transmittance >= kMinTransmittance; ++until_stop)
      transmittance *= 1 - expected[static_cast<std::size_t>(until_stop)].alpha;
    NearestHits nearest(0, 0, kMinTransmittance);
    nearest.start(left);
    offer_all(hits, rng, nearest);
    CHECK(nearest.last_t() < 0.3f * expected.back().t);
    nearest.finish();
    REQUIRE(nearest.count() >= until_stop);
    CHECK(nearest.count() < 64);
    for (int i = 0; i < until_stop; ++i)
      CHECK(same(nearest[i], expected[static_cast<std::size_t>(i)]));
  }
}
