// SPDX-License-Identifier: MIT
// The GPU's rasteriser, its kernels run on the host, against the CPU's.
#include <catch2/catch.hpp>

#include "glint/cuda/ops.h"
#include "tests/support/host_exec.h"
#include "tests/support/random_scene.h"

using namespace glint;
using namespace glint::test;
using namespace glint::gpu;

namespace {

// Maps of a view with room for everything.
RasterOutput room(ImageSize size, int channels, std::size_t surfels) {
  RasterOutput out;
  for_each_map(
      {channels, true, true},
      [&](const char*, int width, Image& map) { fit(map, size, width); },
      out
  );
  out.visibility.resize(surfels);
  out.in_view.resize(surfels);
  out.owned_pixels.resize(surfels);
  out.radii.resize(surfels);
  return out;
}

// Largest difference, relative to the largest value.
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

struct Case {
  ImageSize size;
  int surfels, channels;
  bool distortion, near_limit, plane_distance, statistics;
};
const Case kCases[] = {
    {{1, 1}, 5, 3, false, false, true, true},
    {{16, 16}, 30, 3, true, false, false, false},
    {{17, 33}, 200, 5, true, true, true, false},
    {{50, 31}, 700, 4, false, true, true, true},
    {{33, 31}, 300, 7, false, true, true, true},
    {{70, 40}, 1500, 3, true, false, false, true},
};

struct Fixture {
  SurfelArrays arrays;
  Camera camera;
  Image near_limit;
  RasterSettings settings;
  RasterInput input;

  Fixture(const Case& c, std::uint64_t seed) {
    Rng rng(seed);
    camera = random_camera(rng, c.size);
    RandomSurfels options;
    options.count = static_cast<std::size_t>(c.surfels);
    options.channels = c.channels;
    options.edge_on = options.at_camera = options.behind = options.huge = options.tiny = 0.1;
    arrays = random_surfels(options, camera, rng);
    if (c.near_limit) {
      near_limit = Image(c.size.width, c.size.height, 1);
      for (float& z : near_limit.values()) z = rng.uniform(0.2f, 4);
    }
    settings.with_distortion = c.distortion;
    settings.with_plane_distance = c.plane_distance;
    settings.with_statistics = c.statistics;
    settings.scalar = true;
    input = arrays.view();
    if (c.near_limit) input.near_limit = near_limit;
  }
  RasterCall call() const { return {input, camera, settings}; }
};

}  // namespace

TEST_CASE("The GPU's rasteriser on the host makes the CPU's maps") {
  std::uint64_t seed = 1;
  for (const Case& c : kCases) {
    CAPTURE(c.size.width, c.surfels);
    const Fixture f(c, seed++);
    Rasterizer cpu;
    const RasterOutput& expected = cpu.forward(f.call());
    HostExec exec;
    RasterPipeline<HostExec> gpu(exec);
    RasterOutput actual = room(c.size, c.channels, f.arrays.count());
    gpu.forward(device_call(f.call(), actual));
    // The same text in the same order: the same bytes.
    for_each_map(
        f.call().maps(),
        [](const char* name, int channels, const Image& a, const Image& b) {
          INFO(name);
          if (channels > 0) CHECK(difference(a.values(), b.values()) == 0);
        },
        actual,
        expected
    );
    CHECK(difference(actual.visibility, expected.visibility) < 1e-5);
    if (!c.statistics) continue;
    CHECK(difference(actual.owned_pixels, expected.owned_pixels) == 0);
    CHECK(difference(actual.radii, expected.radii) == 0);
  }
}

TEST_CASE("The GPU's rasteriser on the host makes the CPU's gradients") {
  std::uint64_t seed = 11;
  for (const Case& c : kCases) {
    CAPTURE(c.size.width, c.surfels);
    const Fixture f(c, seed++);
    Rng rng(seed);
    RasterOutput maps = room(c.size, c.channels, f.arrays.count());
    RasterOutputGradient dL_doutput = maps;
    for_each_map(
        {c.channels, true, true},
        [&](const char*, int, Image& map) {
          for (float& value : map.values()) value = rng.normal();
        },
        dL_doutput
    );
    Rasterizer cpu;
    cpu.forward(f.call());
    const RasterGradient& expected = cpu.backward(dL_doutput);
    RasterGradient actual = expected;
    RasterGradient::for_each_array(
        {},
        [](const char*, std::size_t, FloatArray& values) {
          std::fill(values.begin(), values.end(), -1.0f);
        },
        actual
    );
    HostExec exec;
    RasterPipeline<HostExec> gpu(exec);
    gpu.forward(device_call(f.call(), maps));
    gpu.backward(device_maps(dL_doutput), device_gradients(actual));
    RasterGradient::for_each_array(
        {},
        [](const char* name, std::size_t, const FloatArray& a, const FloatArray& b) {
          INFO(name);
          CHECK(difference(a, b) < 2e-5);  // sums over pixels in another order
        },
        actual,
        expected
    );
  }
}

TEST_CASE("The GPU's rasteriser on the host does without surfels") {
  const Fixture f({{20, 10}, 0, 3, false, false, false, true}, 3);
  HostExec exec;
  RasterPipeline<HostExec> gpu(exec);
  RasterOutput maps = room({20, 10}, 3, 0);
  gpu.forward(device_call(f.call(), maps));
  for (const float alpha : maps.alpha.values()) CHECK(alpha == 0.0f);
  CHECK(gpu.num_pairs() == 0);
}
