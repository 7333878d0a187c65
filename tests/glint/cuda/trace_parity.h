// SPDX-License-Identifier: MIT
// Random surfels and rays, and the GPU's tracer, its kernels run on the host, against the CPU's.
#pragma once

#include <catch2/catch.hpp>
#include <limits>

#include "tests/glint/cuda/trace_scenes.h"
#include "tests/support/relative_difference.h"

namespace glint::test {

inline constexpr ImageSize kParitySize{23, 17};

// Surfels in a ball of radius 2 m; every tenth twice.
inline TraceArrays random_arrays(std::size_t count, Rng& rng) {
  TraceArrays arrays;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d mean = uniform(rng, 0, 2) * random_direction(rng);
    const double size = log_uniform(rng, 0.05, 0.6), stretch = log_uniform(rng, 0.4, 2.5);
    const Vec4<double> q = random_unit_quaternion(rng);
    const double opacity = uniform(rng, 0.05, 1);
    for (int copy = 0; copy < (i % 10 == 0 ? 2 : 1); ++copy)
      arrays.add(mean, {size, size * stretch}, q, opacity, rng);
  }
  return arrays;
}

inline Rays random_rays(ImageSize size, Rng& rng) {
  Rays rays{Image(size.width, size.height, 3), Image(size.width, size.height, 3)};
  for (float& value : rays.origins.values()) value = 1.5f * rng.normal();
  for (float& value : rays.directions.values()) value = rng.normal();
  for (int c = 0; c < 3; ++c) rays.directions.at(1, 0, c) = 0;  // none
  rays.origins.at(2, 0, 1) = std::numeric_limits<float>::quiet_NaN();
  return rays;
}

inline TraceOutputGradient random_gradient(ImageSize size, Rng& rng) {
  const TraceOutput noise = empty_output(size);
  TraceOutputGradient g{noise.color, noise.alpha, noise.depth_sum, noise.normal};
  for (Image* image : {&g.color, &g.alpha, &g.depth_sum, &g.normal})
    for (float& value : image->values()) value = rng.normal();
  return g;
}

// Arrays of a gradient, none of them yet what it will be.
inline TraceGradient unset_gradient(std::size_t count, ImageSize size) {
  const auto array = [&](std::size_t width) { return FloatArray(width * count, -7.0f); };
  const Image rays(size.width, size.height, 3, -7.0f);
  return {
      array(3),
      array(2),
      array(4),
      array(1),
      array(3),
      array(45),
      {rays, rays},
      array(1),
      array(3)};
}
// f(name, values) for each array.
template <class F>
void for_each_gradient(const TraceGradient& g, F&& f) {
  f("means", std::span<const float>(g.means));
  f("scales", std::span<const float>(g.scales));
  f("rotations", std::span<const float>(g.rotations));
  f("opacities", std::span<const float>(g.opacities));
  f("sh_dc", std::span<const float>(g.sh_dc));
  f("sh_rest", std::span<const float>(g.sh_rest));
  f("visibility", std::span<const float>(g.visibility));
  f("half_depths", std::span<const float>(g.half_depths));
  f("origins", std::span<const float>(g.rays.origins.values()));
  f("directions", std::span<const float>(g.rays.directions.values()));
}
inline std::vector<float> all_values(const TraceGradient& g) {
  std::vector<float> all;
  for_each_gradient(g, [&](const char*, std::span<const float> values) {
    all.insert(all.end(), values.begin(), values.end());
  });
  return all;
}

inline void check_same(const TraceOutput& actual, const TraceOutput& expected, double tolerance) {
  for (const auto map :
       {&TraceOutput::color, &TraceOutput::alpha, &TraceOutput::depth_sum, &TraceOutput::normal})
    CHECK(relative_difference((actual.*map).values(), (expected.*map).values()) <= tolerance);
}
inline void check_same(
    const TraceGradient& actual, const TraceGradient& expected, double tolerance
) {
  std::vector<std::span<const float>> of_expected;
  for_each_gradient(expected, [&](const char*, std::span<const float> values) {
    of_expected.push_back(values);
  });
  std::size_t i = 0;
  for_each_gradient(actual, [&](const char* name, std::span<const float> values) {
    INFO(name);
    CHECK(relative_difference(values, of_expected[i++]) <= tolerance);
  });
}

inline constexpr double kTraceRounding = 1e-5;
inline constexpr double kSumsInAnotherOrder = 5e-5;

// Forward and backward on Pipeline as on the CPU.
template <class Exec, int kHits>
void check_as_on_cpu(
    gpu::TracePipeline<Exec, kHits>& pipeline, const TraceCall& call, std::uint64_t seed = 1
) {
  Rng rng(seed);
  const ImageSize size{call.rays.origins.width(), call.rays.origins.height()};
  const TraceOutputGradient g = random_gradient(size, rng);
  Tracer cpu;
  TraceOutput out = empty_output(size);
  check_same(
      (pipeline.forward(gpu::device_call(call, out)), out), cpu.forward(call), kTraceRounding
  );
  CHECK(pipeline.num_hits() == cpu.num_hits());
  TraceGradient gradient = unset_gradient(call.input.count, size);
  pipeline.backward(gpu::device_output(g), gpu::device_gradients(gradient));
  check_same(gradient, cpu.backward(g), kSumsInAnotherOrder);
}
template <int kHits = 16>
void check_as_on_cpu(const TraceArrays& arrays, const Rays& rays, const TraceSettings& settings) {
  HostExec exec;
  gpu::TracePipeline<HostExec, kHits> pipeline(exec);
  check_as_on_cpu(pipeline, TraceCall{arrays.view(), rays, settings});
}

}  // namespace glint::test
