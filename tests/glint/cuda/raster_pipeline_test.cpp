// SPDX-License-Identifier: MIT
// The GPU's rasteriser, its kernels run on the host, against the CPU's.
#include "glint/cuda/raster_pipeline.h"

#include <catch2/catch.hpp>

#include "glint/render/raster_tiles.h"
#include "tests/support/host_exec.h"
#include "tests/support/random_scene.h"

using namespace glint;
using namespace glint::test;
using namespace glint::gpu;

namespace {

// Images of a view with room for everything, and pointers to them.
struct Maps {
  Image features, alpha, depth_sum, depth_median, normal, distortion;
  std::vector<float> visible;
  std::vector<std::uint8_t> in_view;

  Maps(ImageSize size, int channels)
      : features(size.width, size.height, channels),
        alpha(size.width, size.height, 1),
        depth_sum(alpha),
        depth_median(alpha),
        normal(size.width, size.height, 3),
        distortion(alpha) {}
  float* visibility(std::size_t surfels) {
    visible.resize(surfels);
    return visible.data();
  }
  std::uint8_t* seen(std::size_t surfels) {
    in_view.resize(surfels);
    return in_view.data();
  }
  DeviceImages pointers() {
    return {
        features.data(),
        alpha.data(),
        depth_sum.data(),
        depth_median.data(),
        normal.data(),
        distortion.data()};
  }
};

DeviceSurfels pointers(const SurfelArrays& a) {
  return {
      a.count(),
      a.channels,
      a.means.data(),
      a.scales.data(),
      a.rotations.data(),
      a.opacities.data(),
      a.features.data()};
}

RasterGradient sized_gradient(const SurfelArrays& a) {
  RasterGradient g;
  g.means.resize(3 * a.count());
  g.scales.resize(2 * a.count());
  g.rotations.resize(4 * a.count());
  g.opacities.resize(a.count());
  g.features.resize(a.features.size());
  g.screen.resize(2 * a.count());
  return g;
}
DeviceGradients pointers(RasterGradient& g) {
  return {
      g.means.data(),
      g.scales.data(),
      g.rotations.data(),
      g.opacities.data(),
      g.features.data(),
      g.screen.data()};
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
  bool distortion, near_limit;
};
const Case kCases[] = {
    {{1, 1}, 5, 3, false, false},
    {{16, 16}, 30, 3, true, false},
    {{17, 33}, 200, 5, true, true},
    {{50, 31}, 700, 4, false, true},
    {{70, 40}, 1500, 3, true, false},
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
    input = arrays.view();
    if (c.near_limit) input.near_limit = near_limit;
  }
  DistortionRange range() const {
    return {settings.with_distortion, settings.distortion_near, settings.distortion_far};
  }
  const float* limit() const { return near_limit.empty() ? nullptr : near_limit.data(); }
};

}  // namespace

TEST_CASE("The GPU's rasteriser on the host makes the CPU's maps") {
  std::uint64_t seed = 1;
  for (const Case& c : kCases) {
    CAPTURE(c.size.width, c.surfels);
    Fixture f(c, seed++);
    Rasterizer cpu;
    RasterOutput expected;
    cpu.forward(f.input, f.camera, f.settings, expected, true);
    HostExec exec;
    RasterPipeline<HostExec> gpu(exec);
    Maps maps(c.size, c.channels);
    const CameraOf<float> camera = camera_of(f.camera, f.settings.near_plane);
    gpu.forward(
        pointers(f.arrays),
        camera,
        f.limit(),
        f.range(),
        maps.pointers(),
        maps.visibility(f.arrays.count()),
        maps.seen(f.arrays.count())
    );
    // The same text in the same order: the same bytes.
    CHECK(difference(maps.features.values(), expected.features.values()) == 0);
    CHECK(difference(maps.alpha.values(), expected.alpha.values()) == 0);
    CHECK(difference(maps.depth_sum.values(), expected.depth_sum.values()) == 0);
    CHECK(difference(maps.depth_median.values(), expected.depth_median.values()) == 0);
    CHECK(difference(maps.normal.values(), expected.normal.values()) == 0);
    if (c.distortion)
      CHECK(difference(maps.distortion.values(), expected.distortion.values()) == 0);
    CHECK(difference(maps.visible, expected.visibility) < 1e-5);
  }
}

TEST_CASE("The GPU's rasteriser on the host makes the CPU's gradients") {
  std::uint64_t seed = 11;
  for (const Case& c : kCases) {
    CAPTURE(c.size.width, c.surfels);
    Fixture f(c, seed++);
    Rasterizer cpu;
    RasterOutput output;
    cpu.forward(f.input, f.camera, f.settings, output, true);
    Rng rng(seed);
    Maps g(c.size, c.channels), maps(c.size, c.channels);
    for (Image* image :
         {&g.features, &g.alpha, &g.depth_sum, &g.depth_median, &g.normal, &g.distortion})
      for (float& value : image->values()) value = rng.normal();
    RasterOutputGradient dL_doutput{
        g.features, g.alpha, g.depth_sum, g.depth_median, g.normal, g.distortion};
    RasterGradient expected, actual = sized_gradient(f.arrays);
    cpu.backward(f.input, f.camera, f.settings, output, dL_doutput, expected, true);
    HostExec exec;
    RasterPipeline<HostExec> gpu(exec);
    const CameraOf<float> camera = camera_of(f.camera, f.settings.near_plane);
    gpu.forward(
        pointers(f.arrays),
        camera,
        f.limit(),
        f.range(),
        maps.pointers(),
        maps.visibility(f.arrays.count()),
        maps.seen(f.arrays.count())
    );
    gpu.backward(pointers(f.arrays), camera, maps.pointers(), g.pointers(), pointers(actual));
    // Sums over pixels in another order.
    CHECK(difference(actual.means, expected.means) < 2e-5);
    CHECK(difference(actual.scales, expected.scales) < 2e-5);
    CHECK(difference(actual.rotations, expected.rotations) < 2e-5);
    CHECK(difference(actual.opacities, expected.opacities) < 2e-5);
    CHECK(difference(actual.features, expected.features) < 2e-5);
    CHECK(difference(actual.screen, expected.screen) < 2e-5);
  }
}

TEST_CASE("The GPU's rasteriser on the host does without surfels") {
  Fixture f({{20, 10}, 0, 3, false, false}, 3);
  HostExec exec;
  RasterPipeline<HostExec> gpu(exec);
  Maps maps({20, 10}, 3);
  const CameraOf<float> camera = camera_of(f.camera, f.settings.near_plane);
  gpu.forward(
      pointers(f.arrays),
      camera,
      nullptr,
      {},
      maps.pointers(),
      maps.visibility(f.arrays.count()),
      maps.seen(f.arrays.count())
  );
  for (const float alpha : maps.alpha.values()) CHECK(alpha == 0.0f);
  CHECK(gpu.num_pairs() == 0);
}
