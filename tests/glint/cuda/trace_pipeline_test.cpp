// SPDX-License-Identifier: MIT
// The GPU's tracer, its kernels run on the host, against the CPU's.
#include <catch2/catch.hpp>

#include "glint/cuda/ops.h"
#include "tests/support/host_exec.h"
#include "tests/support/random_scene.h"

using namespace glint;
using namespace glint::test;
using namespace glint::gpu;

namespace {

struct Arrays {
  std::vector<float> means, scales, rotations, opacities, sh_dc, sh_rest;
  int sh_degree = 3;

  std::size_t count() const { return opacities.size(); }
  TraceInput host() const {
    TraceInput input;
    input.count = count();
    input.sh_degree = sh_degree;
    input.means = means;
    input.scales = scales;
    input.rotations = rotations;
    input.opacities = opacities;
    input.sh_dc = sh_dc;
    input.sh_rest = sh_rest;
    return input;
  }
};

// Surfels in a ball of radius 2 m; every tenth twice.
Arrays random_arrays(std::size_t count, Rng& rng) {
  Arrays a;
  const auto add = [](std::vector<float>& to, std::initializer_list<float> values) {
    to.insert(to.end(), values);
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f mean = cast<float>(uniform(rng, 0, 2) * random_direction(rng));
    const float size = static_cast<float>(log_uniform(rng, 0.05, 0.6));
    const float stretch = static_cast<float>(log_uniform(rng, 0.4, 2.5));
    const Vec4<float> q{rng.normal(), rng.normal(), rng.normal(), rng.normal()};
    const float opacity = rng.uniform(0.05f, 1);
    std::vector<float> color(48);
    for (float& value : color) value = 0.3f * rng.normal();
    for (int copy = 0; copy < (i % 10 == 0 ? 2 : 1); ++copy) {
      add(a.means, {mean.x, mean.y, mean.z});
      add(a.scales, {size, size * stretch});
      add(a.rotations, {q.w, q.x, q.y, q.z});
      add(a.opacities, {opacity});
      a.sh_dc.insert(a.sh_dc.end(), color.begin(), color.begin() + 3);
      a.sh_rest.insert(a.sh_rest.end(), color.begin() + 3, color.end());
    }
  }
  return a;
}

Rays random_rays(int width, int height, Rng& rng) {
  Rays rays{Image(width, height, 3), Image(width, height, 3)};
  for (float& value : rays.origins.values()) value = 1.5f * rng.normal();
  for (float& value : rays.directions.values()) value = rng.normal();
  for (int c = 0; c < 3; ++c) rays.directions.at(1, 0, c) = 0;  // none
  rays.origins.at(2, 0, 1) = std::numeric_limits<float>::quiet_NaN();
  return rays;
}

TraceOutput room(ImageSize size) {
  const Image one(size.width, size.height, 1), three(size.width, size.height, 3);
  return {.color = three, .alpha = one, .depth_sum = one, .normal = three};
}

double difference(std::span<const float> a, std::span<const float> b) {
  REQUIRE(a.size() == b.size());
  double largest = 0, scale = 1e-20;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = static_cast<double>(a[i]), y = static_cast<double>(b[i]);
    largest = std::max(largest, std::abs(x - y));
    scale = std::max(scale, std::abs(y));
  }
  return largest / scale;
}

constexpr ImageSize kSize{23, 17};

void check_forward(const Arrays& arrays, const Rays& rays, const TraceSettings& settings) {
  const TraceCall call{arrays.host(), rays, settings};
  Tracer cpu;
  const TraceOutput& expected = cpu.forward(call);
  HostExec exec;
  TracePipeline<HostExec> gpu(exec);
  TraceOutput out = room(kSize);
  gpu.forward(device_call(call, out));
  CHECK(difference(out.color.values(), expected.color.values()) < 1e-5);
  CHECK(difference(out.alpha.values(), expected.alpha.values()) < 1e-5);
  CHECK(difference(out.depth_sum.values(), expected.depth_sum.values()) < 1e-5);
  CHECK(difference(out.normal.values(), expected.normal.values()) < 1e-5);
}

}  // namespace

TEST_CASE("The GPU's tracer on the host sees what the CPU's sees") {
  Rng rng(5);
  for (const std::size_t count : {1, 2, 3, 50, 2000}) {
    CAPTURE(count);
    const Arrays arrays = random_arrays(count, rng);
    check_forward(arrays, random_rays(kSize.width, kSize.height, rng), {});
  }
}

TEST_CASE("The GPU's tracer on the host follows the cut-offs") {
  Rng rng(6);
  Arrays arrays = random_arrays(400, rng);
  arrays.sh_degree = 1;
  arrays.means[30] = std::numeric_limits<float>::quiet_NaN();
  arrays.opacities[5] = 0;
  TraceSettings settings;
  settings.near = 0.5f;
  settings.min_transmittance = 0.05f;
  settings.max_hits = 7;
  check_forward(arrays, random_rays(kSize.width, kSize.height, rng), settings);
}

TEST_CASE("The GPU's tracer on the host makes the CPU's gradients") {
  Rng rng(7);
  const Arrays arrays = random_arrays(600, rng);
  const Rays rays = random_rays(kSize.width, kSize.height, rng);
  const TraceCall call{arrays.host(), rays, {}};
  const TraceOutput noise = room(kSize);
  TraceOutputGradient g{noise.color, noise.alpha, noise.depth_sum, noise.normal};
  for (Image* image : {&g.color, &g.alpha, &g.depth_sum, &g.normal})
    for (float& value : image->values()) value = rng.normal();
  Tracer cpu;
  cpu.forward(call);
  const TraceGradient& expected = cpu.backward(g);

  HostExec exec;
  TracePipeline<HostExec> gpu(exec);
  TraceOutput out = room(kSize);
  gpu.forward(device_call(call, out));
  TraceGradient actual = expected;
  for (FloatArray* values :
       {&actual.means, &actual.scales, &actual.rotations, &actual.sh_dc, &actual.sh_rest})
    std::fill(values->begin(), values->end(), -1.0f);
  gpu.backward(device_output(g), device_gradients(actual));
  constexpr double kSumsInAnotherOrder = 5e-5;
  CHECK(difference(actual.means, expected.means) < kSumsInAnotherOrder);
  CHECK(difference(actual.scales, expected.scales) < kSumsInAnotherOrder);
  CHECK(difference(actual.rotations, expected.rotations) < kSumsInAnotherOrder);
  CHECK(difference(actual.opacities, expected.opacities) < kSumsInAnotherOrder);
  CHECK(difference(actual.sh_dc, expected.sh_dc) < kSumsInAnotherOrder);
  CHECK(difference(actual.sh_rest, expected.sh_rest) < kSumsInAnotherOrder);
  CHECK(difference(actual.half_depths, expected.half_depths) < kSumsInAnotherOrder);
  CHECK(difference(actual.visibility, expected.visibility) < kSumsInAnotherOrder);
  CHECK(
      difference(actual.rays.origins.values(), expected.rays.origins.values()) < kSumsInAnotherOrder
  );
  CHECK(
      difference(actual.rays.directions.values(), expected.rays.directions.values()) <
      kSumsInAnotherOrder
  );
}

TEST_CASE("A refitted tree finds surfels where they moved to") {
  Rng rng(8);
  Arrays arrays = random_arrays(300, rng);
  const Rays rays = random_rays(kSize.width, kSize.height, rng);
  HostExec exec;
  TracePipeline<HostExec> refitted(exec), fresh(exec);
  TraceOutput a = room(kSize), b = room(kSize);
  const TraceCall call{arrays.host(), rays, {}};
  refitted.forward(device_call(call, a));
  for (float& value : arrays.means) value += 0.5f * rng.normal();
  refitted.forward(device_call(call, a));
  fresh.forward(device_call(call, b));
  CHECK(difference(a.color.values(), b.color.values()) == 0);
  CHECK(difference(a.depth_sum.values(), b.depth_sum.values()) == 0);
}
