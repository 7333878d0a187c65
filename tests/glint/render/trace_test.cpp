// SPDX-License-Identifier: MIT
// trace() against the brute-force tracer in double, against rasterize(), and on scenes whose answer
// is known.
#include "glint/render/trace.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "glint/core/parallel.h"
#include "glint/render/rasterize.h"
#include "glint/render/spherical_harmonics.h"
#include "tests/support/gradcheck.h"
#include "tests/support/random_scene.h"
#include "tests/support/reference_trace.h"
#include "tests/support/same_bytes.h"
#include "tests/support/trace_arrays.h"

using namespace glint;
using namespace glint::test;

namespace {

// Surfels in a ball of radius 2 m.
TraceArrays random_arrays(std::size_t count, Rng& rng) {
  TraceArrays arrays;
  for (std::size_t i = 0; i < count; ++i) {
    const double size = log_uniform(rng, 0.05, 0.6);
    const Vec2d scale{size, size * log_uniform(rng, 0.4, 2.5)};
    const double length = uniform(rng, 0.5, 2);
    const Vec4<double> q = random_unit_quaternion(rng);
    arrays.add(
        uniform(rng, 0, 2) * random_direction(rng),
        scale,
        {length * q.w, length * q.x, length * q.y, length * q.z},
        uniform(rng, 0.05, 1),
        rng
    );
  }
  return arrays;
}

void set_ray(Rays& rays, std::size_t i, Vec3d origin, Vec3d direction) {
  for (int k = 0; k < 3; ++k) {
    rays.origins.data()[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(origin[k]);
    rays.directions.data()[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(direction[k]);
  }
}
Rays empty_rays(int width, int height) {
  return {Image(width, height, 3), Image(width, height, 3)};
}
// From points in the ball, in all directions, of lengths that are not 1.
Rays random_rays(int width, int height, Rng& rng) {
  Rays rays = empty_rays(width, height);
  for (std::size_t i = 0; i < rays.origins.num_pixels(); ++i)
    set_ray(
        rays,
        i,
        uniform(rng, 0, 2.5) * random_direction(rng),
        uniform(rng, 0.5, 2) * random_direction(rng)
    );
  return rays;
}

// Checks every output of every ray that is `guard` away from a jump; returns the share of those.
double compare_with_reference(
    const TraceArrays& arrays, const Rays& rays, const TraceSettings& settings, double tolerance
) {
  Tracer tracer;
  const TraceOutput out = tracer.forward({arrays.view(), rays, settings});
  const ReferenceTraceInput reference = reference_trace_input(arrays.view(), rays);
  std::size_t clean = 0;
  double worst = 0;
  for (std::size_t i = 0; i < reference.num_rays(); ++i) {
    const ReferenceRay ray = reference_trace(reference, i, settings);
    if (ray.nearest_cutoff < 1e-4) continue;
    ++clean;
    const auto differ = [&](const Image& image, std::size_t at, double expected) {
      worst = std::max(worst, std::abs(static_cast<double>(image.data()[at]) - expected));
    };
    for (int c = 0; c < 3; ++c) {
      differ(out.color, 3 * i + static_cast<std::size_t>(c), ray.color[c]);
      differ(out.normal, 3 * i + static_cast<std::size_t>(c), ray.normal[c]);
    }
    differ(out.alpha, i, ray.alpha);
    differ(out.depth_sum, i, ray.depth_sum);
  }
  CHECK(worst < tolerance);
  return static_cast<double>(clean) / static_cast<double>(reference.num_rays());
}

}  // namespace

TEST_CASE("trace equals the brute-force tracer") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Rng rng(seed);
    const TraceArrays arrays = random_arrays(400, rng);
    TraceSettings settings;
    settings.near = seed == 3 ? 0.3f : 0.0f;
    INFO("seed " << seed);
    CHECK(compare_with_reference(arrays, random_rays(40, 25, rng), settings, 2e-4) > 0.8);
  }
}

TEST_CASE("trace follows its cut-offs") {
  Rng rng(4);
  const TraceArrays arrays = random_arrays(300, rng);
  const Rays rays = random_rays(30, 20, rng);
  TraceSettings settings;
  settings.max_rho = 4;
  settings.min_alpha = 0.02f;
  settings.min_transmittance = 0.05f;
  CHECK(compare_with_reference(arrays, rays, settings, 2e-4) > 0.8);
  settings.max_hits = 3;
  CHECK(compare_with_reference(arrays, rays, settings, 2e-4) > 0.8);
}

TEST_CASE("coincident surfels count once each, more of them than one traversal returns") {
  Rng rng(5);
  TraceArrays arrays;
  constexpr int kClones = 200;
  for (int i = 0; i < kClones; ++i) arrays.add({0, 0, 1}, {0.5, 0.5}, {1, 0, 0, 0}, 0.02, rng);
  Rays rays = empty_rays(1, 1);
  set_ray(rays, 0, {0, 0, 0}, {0, 0, 1});
  Tracer tracer;
  const TraceOutput out = tracer.forward({arrays.view(), rays, {}});
  CHECK(tracer.num_hits() == kClones);
  CHECK(
      static_cast<double>(out.alpha.data()[0]) == Approx(1 - std::pow(0.98, kClones)).margin(1e-5)
  );
}

namespace {

// Face on within 3 degrees and half a metre apart: rasterize's order (of centres) and trace's (of
// hits) agree, and the low-pass never holds.
TraceArrays layered_arrays(const Camera& camera, Rng& rng) {
  TraceArrays arrays;
  arrays.sh_degree = 0;
  for (int i = 0; i < 14; ++i) {
    const double depth = 1 + 0.5 * i, size = depth / camera.fx * uniform(rng, 3, 8);
    const Vec3d point = random_point_in_view(rng, camera, depth);
    const Vec3d normal = normalize(normalize(point) + 0.05 * random_direction(rng));
    const std::vector<float> feature{rng.uniform(), rng.uniform(), rng.uniform()};
    arrays.surfels.add(
        camera.to_world(point),
        {size, 0.8 * size},
        quaternion_with_normal(rng, transpose_times(camera.rotation_cam_from_world, normal)),
        uniform(rng, 0.3, 1),
        feature
    );
    for (const float f : feature) arrays.sh_dc.push_back((f - 0.5f) / kSh0);
    arrays.sh_rest.insert(arrays.sh_rest.end(), 45, 0.0f);
  }
  return arrays;
}

// Rays of the pixels (camera z = 1), starting at a planar depth.
Rays pixel_rays(const Camera& camera, const Image& start) {
  Rays rays = empty_rays(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const auto i = static_cast<std::size_t>(y * camera.width + x);
      const Vec3d in_cam = camera.ray_in_cam(x + 0.5, y + 0.5);
      const Vec3d direction = transpose_times(camera.rotation_cam_from_world, in_cam);
      const auto z = static_cast<double>(start.data()[i]);
      set_ray(rays, i, camera.center() + z * direction, direction);
    }
  return rays;
}

// Share of the pixels where both agree; depths of `traced` are behind `start`. Pixels where a hit
// lies at a cut-off may differ.
double share_that_agrees(
    const TraceOutput& traced, const RasterOutput& raster, const Image& start
) {
  std::size_t agree = 0;
  const std::size_t pixels = traced.alpha.num_pixels();
  for (std::size_t i = 0; i < pixels; ++i) {
    const float alpha = raster.alpha.data()[i];
    const float depth = raster.depth_sum.data()[i] - alpha * start.data()[i];
    agree += std::abs(traced.alpha.data()[i] - alpha) < 1e-4f &&
             std::abs(traced.depth_sum.data()[i] - depth) < 1e-3f &&
             std::abs(traced.color.data()[3 * i] - raster.features.data()[3 * i]) < 1e-4f;
  }
  return static_cast<double>(agree) / static_cast<double>(pixels);
}

}  // namespace

TEST_CASE("camera rays see what rasterize sees where the low-pass is inactive") {
  Rng rng(6);
  const Camera camera = random_camera(rng, {48, 32});
  const TraceArrays arrays = layered_arrays(camera, rng);
  Rasterizer rasterizer;
  const RasterOutput raster = rasterizer.forward({arrays.surfels.view(), camera, {}});
  const Image start(camera.width, camera.height, 1);
  TraceSettings settings;
  settings.near = 0.2f;
  Tracer tracer;
  const TraceOutput out = tracer.forward({arrays.view(), pixel_rays(camera, start), settings});
  std::size_t covered = 0;
  for (const float alpha : raster.alpha.values()) covered += alpha > 0.1f;
  CHECK(covered > 300);
  CHECK(share_that_agrees(out, raster, start) > 0.97);
}

TEST_CASE("rasterising behind a depth map is tracing the camera rays on from there") {
  Rng rng(16);
  const Camera camera = random_camera(rng, {48, 32});
  const TraceArrays arrays = layered_arrays(camera, rng);
  Image start(camera.width, camera.height, 1);
  for (float& z : start.values()) z = rng.uniform(0.3f, 6);
  RasterInput input = arrays.surfels.view();
  input.near_limit = start;
  Rasterizer rasterizer;
  const RasterOutput raster = rasterizer.forward({input, camera, {}});
  Tracer tracer;
  const TraceOutput out = tracer.forward({arrays.view(), pixel_rays(camera, start), {}});
  CHECK(share_that_agrees(out, raster, start) > 0.97);
}

TEST_CASE("a mirrored ray sees the surfel in the mirror") {
  Rng rng(7);
  TraceArrays arrays;
  arrays.add({0.4, 0, -1}, {0.1, 0.1}, {1, 0, 0, 0}, 0.9, rng);  // behind the camera
  Rays rays = empty_rays(2, 1);
  // From the mirror point (0.2, 0, 1) of the plane z = 1, and 0.3 m beside it.
  set_ray(rays, 0, {0.2, 0, 1}, {0.2, 0, -2});
  set_ray(rays, 1, {0.5, 0, 1}, {0.2, 0, -2});
  Tracer tracer;
  const TraceOutput out = tracer.forward({arrays.view(), rays, {}});
  CHECK(out.alpha.data()[0] == Approx(0.9f).margin(1e-5));
  CHECK(out.depth_sum.data()[0] == Approx(0.9f).margin(1e-4));  // t = 1 in units of the direction
  CHECK(out.normal.data()[2] == Approx(0.9f).margin(1e-5));     // towards the mirror
  CHECK(out.alpha.data()[1] == Approx(0.9 * std::exp(-0.5 * 9)).margin(2e-2));
}

TEST_CASE("a ray that starts on a surfel does not see it, and sees what lies behind") {
  Rng rng(8);
  TraceArrays arrays;
  arrays.add({0, 0, 1}, {0.5, 0.5}, {1, 0, 0, 0}, 0.5, rng);
  arrays.add({0, 0, 2}, {0.5, 0.5}, {1, 0, 0, 0}, 0.5, rng);
  Rays rays = empty_rays(1, 1);
  set_ray(rays, 0, {0, 0, 1}, {0, 0, 1});
  Tracer tracer;
  const TraceOutput out = tracer.forward({arrays.view(), rays, {}});
  CHECK(tracer.num_hits() == 1);
  CHECK(out.depth_sum.data()[0] == Approx(0.5f));
}

TEST_CASE("no surfels, and rays without direction, give nothing and no gradient") {
  Rng rng(9);
  for (const std::size_t count : {std::size_t{0}, std::size_t{20}}) {
    const TraceArrays arrays = random_arrays(count, rng);
    const Rays rays = count == 0 ? random_rays(4, 3, rng) : empty_rays(4, 3);
    Tracer tracer;
    const TraceOutput out = tracer.forward({arrays.view(), rays, {}});
    CHECK(tracer.num_hits() == 0);
    for (const float alpha : out.alpha.values()) CHECK(alpha == 0.0f);
    TraceOutputGradient g;
    g.color = Image(4, 3, 3, 1.0f);
    const TraceGradient gradient = tracer.backward(g);
    for (const float value : gradient.rays.directions.values()) CHECK(value == 0.0f);
    for (const float value : gradient.means) CHECK(value == 0.0f);
  }
}

TEST_CASE("rays that are not finite count as none, those beside them as ever") {
  Rng rng(19);
  const TraceArrays arrays = random_arrays(30, rng);
  Rays rays = random_rays(6, 4, rng);
  Tracer tracer;
  TraceOutput before, after;
  before = tracer.forward({arrays.view(), rays, {}});
  rays.origins.data()[0] = std::numeric_limits<float>::quiet_NaN();
  rays.directions.data()[4] = std::numeric_limits<float>::quiet_NaN();
  rays.directions.data()[7] = std::numeric_limits<float>::infinity();
  rays.origins.data()[10] = 1e30f;
  after = tracer.forward({arrays.view(), rays, {}});
  for (std::size_t i = 0; i < 24; ++i)
    CHECK(after.alpha.data()[i] == (i < 4 ? 0.0f : before.alpha.data()[i]));
  TraceOutputGradient g;
  g.color = Image(6, 4, 3, 1.0f);
  const TraceGradient gradient = tracer.backward(g);
  for (const float value : gradient.means) CHECK(std::isfinite(value));
}

TEST_CASE("surfels that moved are found where they are, refitted or rebuilt") {
  Rng rng(10);
  TraceArrays arrays = random_arrays(200, rng);
  const Rays rays = random_rays(20, 20, rng);
  Tracer kept;
  TraceOutput out, fresh_out;
  for (int step = 0; step < 40; ++step) {
    out = kept.forward({arrays.view(), rays, {}});
    if (step % 7 == 0) {
      Tracer fresh;
      fresh_out = fresh.forward({arrays.view(), rays, {}});
      CHECK(same_bytes(out.color, fresh_out.color));
    }
    for (float& value : arrays.surfels.means) value += 0.05f * rng.normal();
    if (step == 20) arrays = random_arrays(150, rng);
  }
}

TEST_CASE("surfels that are not finite or invisible reach no ray") {
  Rng rng(11);
  TraceArrays arrays = random_arrays(3, rng);
  arrays.surfels.means[0] = NAN;
  arrays.surfels.opacities[1] = 0;
  arrays.surfels.scales[4] = INFINITY;
  Tracer tracer;
  const Rays rays = random_rays(10, 10, rng);
  tracer.forward({arrays.view(), rays, {}});
  CHECK(tracer.num_hits() == 0);
}

TEST_CASE("a surfel without extent has no gradient") {
  Rng rng(17);
  TraceArrays arrays = random_arrays(9, rng);
  arrays.surfels.scales[0] = 0;
  const Rays rays = random_rays(10, 10, rng);
  Tracer tracer;
  const TraceOutput out = tracer.forward({arrays.view(), rays, {}});
  REQUIRE(tracer.num_hits() > 0);
  TraceOutputGradient g;
  g.color = Image(10, 10, 3, 1.0f);
  g.normal = Image(10, 10, 3, 1.0f);
  const TraceGradient gradient = tracer.backward(g);
  for (std::size_t k = 0; k < 4; ++k) CHECK(gradient.rotations[k] == 0.0f);
  CHECK(gradient.opacities[0] == 0.0f);
}

TEST_CASE("forward and backward give the same bytes for any number of threads") {
  Rng rng(12);
  const TraceArrays arrays = random_arrays(500, rng);
  const Rays rays = random_rays(60, 40, rng);
  TraceOutputGradient g;
  g.color = Image(60, 40, 3, 1.0f);
  g.depth_sum = Image(60, 40, 1, 0.3f);
  TraceOutput out[2];
  TraceGradient gradient[2];
  for (const int i : {0, 1}) {
    set_num_threads(1 + 3 * i);
    Tracer tracer;
    out[i] = tracer.forward({arrays.view(), rays, {}});
    gradient[i] = tracer.backward(g);
  }
  set_num_threads(0);
  CHECK(same_bytes(out[0].color, out[1].color));
  CHECK(gradient[0].means == gradient[1].means);
  CHECK(gradient[0].rotations == gradient[1].rotations);
  CHECK(gradient[0].sh_rest == gradient[1].sh_rest);
  CHECK(same_bytes(gradient[0].rays.directions, gradient[1].rays.directions));
}

TEST_CASE("wrong sizes are usage errors") {
  Rng rng(13);
  TraceArrays arrays = random_arrays(5, rng);
  Tracer tracer;
  TraceOutput out;
  Rays rays = empty_rays(2, 2);
  rays.directions = Image(2, 1, 3);
  CHECK_THROWS_WITH(tracer.forward({arrays.view(), rays, {}}), Catch::Contains("2x2"));
  arrays.sh_dc.pop_back();
  CHECK_THROWS_WITH(
      tracer.forward({arrays.view(), empty_rays(1, 1), {}}), Catch::Contains("5 surfels")
  );
}
