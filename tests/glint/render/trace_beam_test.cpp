// SPDX-License-Identifier: MIT
// Searches shared by the rays of a beam against the tree: the same hits, and the same bytes of
// every output and gradient.
#include "glint/render/trace_beam.h"

#include <catch2/catch.hpp>
#include <cstring>

#include "glint/core/parallel.h"
#include "glint/render/trace_bvh.h"
#include "tests/support/trace_arrays.h"

using namespace glint;
using namespace glint::test;

namespace {

struct BeamScene : TraceArrays {
  Rays rays{Image(48, 40, 3), Image(48, 40, 3)};
  TraceSettings settings;

  void set_ray(std::size_t i, Vec3d origin, Vec3d direction) {
    for (int k = 0; k < 3; ++k) {
      const std::size_t at = 3 * i + static_cast<std::size_t>(k);
      rays.origins.data()[at] = static_cast<float>(origin[k]);
      rays.directions.data()[at] = static_cast<float>(direction[k]);
    }
  }
};

// Surfels of sizes [smallest, largest] in a box of 4 x 4 x 2 m; every tenth is there twice.
BeamScene random_beam_scene(
    std::size_t count, double smallest, double largest, double opacity, Rng& rng
) {
  BeamScene scene;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d mean{uniform(rng, -2, 2), uniform(rng, -2, 2), uniform(rng, -1, 1)};
    const Vec2d scale{log_uniform(rng, smallest, largest), log_uniform(rng, smallest, largest)};
    const Vec4<double> q = random_unit_quaternion(rng);
    for (int copy = 0; copy < (i % 10 == 0 ? 2 : 1); ++copy)
      scene.surfels.add(mean, scale, q, uniform(rng, 0.2, 1.8) * opacity, {0, 0, 0});
  }
  for (std::size_t i = 0; i < 3 * scene.surfels.count(); ++i)
    scene.sh_dc.push_back(rng.uniform(-1, 1));
  for (std::size_t i = 0; i < 45 * scene.surfels.count(); ++i)
    scene.sh_rest.push_back(0.2f * rng.uniform(-1, 1));
  return scene;
}

// Rays of a camera, mirrored by the walls x = 2 and y = 2, whose edge runs through the image; their
// lengths differ.
void mirror_at_edge(BeamScene& scene, Rng& rng) {
  const Vec3d eye{-1.5, -1.4, 0.1};
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 48; ++x) {
      Vec3d d = normalize(Vec3d{1 + (x - 24) * 0.02, 1 - (x - 24) * 0.02, (y - 20) * 0.02});
      const double to_x = (2 - eye.x) / d.x, to_y = (2 - eye.y) / d.y;
      const Vec3d origin = eye + std::min(to_x, to_y) * d;
      (to_x < to_y ? d.x : d.y) *= -1;
      scene.set_ray(static_cast<std::size_t>(48 * y + x), origin, uniform(rng, 0.2, 4) * d);
    }
}

void incoherent(BeamScene& scene, Rng& rng) {
  for (std::size_t i = 0; i < scene.rays.origins.num_pixels(); ++i)
    scene.set_ray(i, uniform(rng, 0, 2) * random_direction(rng), random_direction(rng));
}

// Some rays without direction, and some that start on a surfel.
void disturb(BeamScene& scene) {
  for (std::size_t i = 0; i < scene.rays.origins.num_pixels(); i += 7)
    for (std::size_t k = 0; k < 3; ++k) {
      if (i % 2 == 0) scene.rays.directions.data()[3 * i + k] = 0;
      scene.rays.origins.data()[3 * i + 3 + k] = scene.surfels.means[3 * (i % 50) + k];
    }
}

struct Traced {
  TraceOutput out;
  TraceGradient gradient;
  std::size_t hits = 0;
};

Traced trace(const BeamScene& scene, TraceSearch search, bool triangles = false) {
  TraceSettings settings = scene.settings;
  settings.search = search;
  settings.triangles = triangles;
  const TraceOutputGradient g{
      Image(48, 40, 3, 1.0f),
      Image(48, 40, 1, -0.4f),
      Image(48, 40, 1, 0.3f),
      Image(48, 40, 3, 0.2f)};
  Tracer tracer;
  Traced traced;
  traced.out = tracer.forward({scene.view(), scene.rays, settings});
  traced.gradient = tracer.backward(g);
  traced.hits = tracer.num_hits();
  return traced;
}

bool same_bytes(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}
bool same_bytes(const Image& a, const Image& b) { return same_bytes(a.values(), b.values()); }

void check_same(const Traced& a, const Traced& b) {
  CHECK(a.hits == b.hits);
  CHECK(same_bytes(a.out.color, b.out.color));
  CHECK(same_bytes(a.out.alpha, b.out.alpha));
  CHECK(same_bytes(a.out.depth_sum, b.out.depth_sum));
  CHECK(same_bytes(a.out.normal, b.out.normal));
  CHECK(same_bytes(a.gradient.means, b.gradient.means));
  CHECK(same_bytes(a.gradient.scales, b.gradient.scales));
  CHECK(same_bytes(a.gradient.rotations, b.gradient.rotations));
  CHECK(same_bytes(a.gradient.opacities, b.gradient.opacities));
  CHECK(same_bytes(a.gradient.sh_dc, b.gradient.sh_dc));
  CHECK(same_bytes(a.gradient.sh_rest, b.gradient.sh_rest));
  CHECK(same_bytes(a.gradient.rays.origins, b.gradient.rays.origins));
  CHECK(same_bytes(a.gradient.rays.directions, b.gradient.rays.directions));
}

void check_searches(const BeamScene& scene) {
  const Traced tree = trace(scene, TraceSearch::kTree);
  CHECK(tree.hits > 1000);
  check_same(tree, trace(scene, TraceSearch::kBeams));
  check_same(tree, trace(scene, TraceSearch::kCheapest));
}

}  // namespace

TEST_CASE("mirrored rays across an edge see the same with and without beams") {
  for (const double largest : {0.05, 0.4, 3.0}) {
    INFO("largest surfel " << largest);
    Rng rng(21);
    BeamScene scene = random_beam_scene(2000, 0.02, largest, 0.3, rng);
    mirror_at_edge(scene, rng);
    check_searches(scene);
    disturb(scene);
    scene.settings.near = 0.3f;
    check_searches(scene);
  }
}

TEST_CASE("rays in all directions see the same with and without beams") {
  Rng rng(22);
  BeamScene scene = random_beam_scene(1500, 0.02, 0.5, 0.5, rng);
  incoherent(scene, rng);
  disturb(scene);
  check_searches(scene);
}

TEST_CASE("rays with more hits than a search returns see the same with and without beams") {
  Rng rng(23);
  BeamScene scene = random_beam_scene(4000, 0.3, 1.0, 0.015, rng);
  mirror_at_edge(scene, rng);
  scene.settings.max_hits = 100000;
  const Traced tree = trace(scene, TraceSearch::kTree);
  CHECK(tree.hits > 3 * NearestHits::kCapacity / 2 * scene.rays.origins.num_pixels());
  check_same(tree, trace(scene, TraceSearch::kBeams));
  scene.settings.max_hits = 150;
  check_searches(scene);
}

TEST_CASE("beams follow the cut-offs of a ray") {
  Rng rng(24);
  BeamScene scene = random_beam_scene(3000, 0.1, 0.4, 0.3, rng);
  mirror_at_edge(scene, rng);
  scene.settings.max_rho = 4;
  scene.settings.min_alpha = 0.02f;
  scene.settings.min_transmittance = 0.02f;
  for (const int most : {0, 1, 5, 64}) {
    scene.settings.max_hits = most;
    check_same(trace(scene, TraceSearch::kTree), trace(scene, TraceSearch::kBeams));
  }
}

TEST_CASE("beams follow the stops of each ray") {
  Rng rng(28);
  BeamScene scene = random_beam_scene(3000, 0.1, 0.4, 0.1, rng);
  mirror_at_edge(scene, rng);
  scene.settings.min_transmittance = 0.02f;
  const std::size_t hits = trace(scene, TraceSearch::kTree).hits;
  scene.rays.stops = random_stops(scene.rays.origins.size(), rng);
  check_searches(scene);
  CHECK(trace(scene, TraceSearch::kTree).hits < hits);
}

TEST_CASE("beams do not touch what triangles give") {
  Rng rng(25);
  BeamScene scene = random_beam_scene(500, 0.1, 0.4, 0.3, rng);
  mirror_at_edge(scene, rng);
  const Traced tree = trace(scene, TraceSearch::kTree, true);
  CHECK(tree.hits > 1000);
  check_same(tree, trace(scene, TraceSearch::kBeams, true));
  check_same(tree, trace(scene, TraceSearch::kCheapest, true));
}

TEST_CASE(
    "rays that are all the same, and rays of extreme lengths, see the same with and without beams"
) {
  Rng rng(26);
  BeamScene scene = random_beam_scene(300, 0.1, 0.6, 0.3, rng);
  for (std::size_t i = 0; i < scene.rays.origins.num_pixels(); ++i)
    scene.set_ray(i, {1, 0.5, 0}, {-2, 0.3, 0.1});
  check_searches(scene);
  scene.set_ray(5, {0, 0, 0}, {1e18, 0, 0});
  scene.set_ray(6, {0, 0, 0}, {1e-18, 0, 0});
  check_searches(scene);
}

TEST_CASE("beams give the same bytes for any number of threads") {
  Rng rng(27);
  BeamScene scene = random_beam_scene(2000, 0.1, 0.5, 0.3, rng);
  mirror_at_edge(scene, rng);
  scene.rays.origins = Image(480, 40, 3);  // several tiles
  scene.rays.directions = Image(480, 40, 3);
  for (std::size_t i = 0; i < scene.rays.origins.num_pixels(); ++i)
    scene.set_ray(i, {0.001 * static_cast<double>(i % 480), -2, 0}, {0.2, 1, 0.1});
  TraceOutput out[2];
  for (const int i : {0, 1}) {
    set_num_threads(1 + 3 * i);
    out[i] = Tracer().forward({scene.view(), scene.rays, scene.settings});
  }
  set_num_threads(0);
  CHECK(same_bytes(out[0].color, out[1].color));
  CHECK(same_bytes(out[0].alpha, out[1].alpha));
}
