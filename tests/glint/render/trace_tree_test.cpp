// SPDX-License-Identifier: MIT
// Our own tree, linked in place of Embree's: the hits that all clusters give.
#include <catch2/catch.hpp>
#include <cmath>

#include "glint/render/trace_bvh.h"
#include "tests/support/random_scene.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

// Discs in a box of 4 m; every ninth there twice, every eleventh counts nowhere, one is far away.
std::vector<TracedSurfel> random_surfels(std::size_t count, float size, Rng& rng) {
  std::vector<TracedSurfel> surfels(count);
  std::vector<float> means;
  for (std::size_t i = 0; i < count; ++i) {
    TracedSurfel& s = surfels[i];
    s.fields.mean = {rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2)};
    s.fields.h0 = size * cast<float>(random_direction(rng));
    s.fields.h1 = size * cast<float>(random_direction(rng));
    s.fields.opacity = rng.uniform(0.05f, 0.9f);
    s.fields.max_rho = i % 11 == 10 ? -1.0f : 9.0f;
    if (i % 9 == 8) s.fields = surfels[i - 1].fields;
    if (i == 5) s.fields.mean = {900, -900, 900};
    s.surfel = static_cast<std::uint32_t>(i);
    means.insert(means.end(), {s.fields.mean.x, s.fields.mean.y, s.fields.mean.z});
  }
  const std::vector<std::uint32_t> slots = cluster_slots(means);
  std::vector<TracedSurfel> ordered(count);
  for (std::size_t i = 0; i < count; ++i) ordered[slots[i]] = surfels[i];
  return ordered;
}

std::size_t search_all(
    std::span<const SurfelCluster> clusters, Vec3f origin, Vec3f direction, NearestHits& hits
) {
  for (std::size_t i = 0; i < clusters.size(); ++i)
    offer(clusters[i].load(i), all_lanes(origin), all_lanes(direction), hits);
  return clusters.size();
}

// All hits along a ray, search after search.
template <class Search>
std::vector<FoundHit> all_hits(Search&& search) {
  std::vector<FoundHit> found;
  NearestHits hits(0, 1 / 255.0f, 0.01f);
  for (bool more = true; more;) {
    hits.start(1, 4);
    search(hits);
    more = hits.finish();
    for (int i = 0; i < hits.count(); ++i) found.push_back(hits[i]);
  }
  return found;
}

// Rays from inside and outside, some along an axis, some without direction.
Vec3f random_ray_direction(Rng& rng, int i) {
  Vec3f d = rng.uniform(0.1f, 3.0f) * cast<float>(random_direction(rng));
  if (i % 5 == 0) d[i / 5 % 3] = 0;
  if (i % 25 == 0) d = {0, 0, i % 2 == 0 ? -1.0f : 1.0f};
  if (i % 50 == 1) d = {0, 0, 0};
  return d;
}

}  // namespace

TEST_CASE("our own tree finds the hits that all clusters have, in their order") {
  Rng rng(21);
  for (const auto& [count, size] :
       {std::pair{std::size_t{1}, 0.5f}, {7, 0.5f}, {65, 0.3f}, {700, 0.2f}, {5000, 0.05f}}) {
    const std::vector<TracedSurfel> surfels = random_surfels(count, size, rng);
    SurfelBvh bvh;
    bvh.update(surfels, false);
    std::size_t num_hits = 0, looked_at = 0, num_rays = 300;
    for (int i = 0; i < static_cast<int>(num_rays); ++i) {
      Vec3f origin = rng.uniform(0, 4) * cast<float>(random_direction(rng));
      if (i % 7 == 0) origin = surfels[static_cast<std::size_t>(i) % count].fields.mean;
      const Vec3f direction = random_ray_direction(rng, i);
      const auto found =
          all_hits([&](NearestHits& hits) { looked_at += bvh.nearest(origin, direction, hits); });
      const auto expected =
          all_hits([&](NearestHits& hits) { search_all(bvh.clusters(), origin, direction, hits); });
      REQUIRE(found.size() == expected.size());
      num_hits += found.size();
      for (std::size_t k = 0; k < found.size(); ++k) {
        CHECK(found[k] == expected[k]);
        CHECK(found[k].slot == expected[k].slot);
        CHECK(found[k].alpha == expected[k].alpha);
      }
    }
    if (count == 5000) CHECK(looked_at < num_rays * bvh.clusters().size() / 4);
    if (count > 7) CHECK(num_hits > 100);
  }
}

TEST_CASE("our own tree follows surfels that move, and none are no error") {
  Rng rng(22);
  std::vector<TracedSurfel> surfels = random_surfels(100, 0.4f, rng);
  SurfelBvh bvh;
  bvh.update(surfels, false);
  for (TracedSurfel& s : surfels) s.fields.mean.x += 10;
  bvh.update(surfels, true);
  const auto hits_of = [&](Vec3f origin) {
    return all_hits([&](NearestHits& hits) { bvh.nearest(origin, {0, 0, 1}, hits); }).size();
  };
  std::size_t there = 0, gone = 0;
  for (float x = -1; x < 1; x += 0.25f)
    there += hits_of({x + 10, 0, -5}), gone += hits_of({x, 0, -5});
  CHECK(there > 0);
  CHECK(gone == 0);
  surfels.clear();
  bvh.update(surfels, true);
  CHECK(hits_of({10, 0, -5}) == 0);
}
