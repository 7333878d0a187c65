// SPDX-License-Identifier: MIT
// The GPU's rasteriser with as many surfels and pixels as in training, against the CPU's. Of the
// host's kernels all is checked; a device in full, too, where there is one.
#include <catch2/catch.hpp>

#include "tests/support/gpu_backends.h"
#include "tests/support/large_scene.h"

using namespace glint;
using namespace glint::test;
using namespace glint::gpu;

namespace {

const LargeScene& scene() {
  static const LargeScene scene = large_scene();
  return scene;
}

RasterCall call_of(const LargeScene& scene) {
  RasterSettings settings;
  settings.with_distortion = settings.with_statistics = settings.scalar = true;
  return {scene.arrays.view(), scene.camera, settings};
}

RasterOutputGradient gradient_of_maps() {
  Rng rng(3);
  RasterOutputGradient gradient;
  for_each_map(
      {3, true, false},
      [&](const char*, int channels, Image& map) {
        if (channels == 0) return;
        fit(map, kLargeSize, channels);
        for (float& value : map.values()) value = rng.normal();
      },
      gradient
  );
  return gradient;
}

using Results = std::map<std::string, std::vector<float>>;
Results run() {
  const RasterCall call = call_of(scene());
  Rasterizer rasterizer;
  const RasterOutput& out = rasterizer.forward(call);
  const RasterGradient& gradient = rasterizer.backward(gradient_of_maps());
  Results results{
      {"visibility", read(out.visibility)},
      {"owned pixels", read(out.owned_pixels)},
      {"radii", read(out.radii)}};
  for_each_map(
      call.maps(),
      [&](const char* name, int channels, const Image& map) {
        if (channels > 0) results[name] = read(map);
      },
      out
  );
  RasterGradient::for_each_array(
      call.maps(),
      [&](const char* name, std::size_t width, const FloatArray& array) {
        if (width > 0) results["gradient of " + std::string(name)] = read(array);
      },
      gradient
  );
  return results;
}

// Values that differ by more than `tolerance` of the largest.
std::size_t num_different(
    const std::vector<float>& a, const std::vector<float>& b, double tolerance
) {
  REQUIRE(a.size() == b.size());
  double scale = 0;
  for (const float v : b) scale = std::max(scale, std::abs(static_cast<double>(v)));
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i)  // NaN counts
    count +=
        !(std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])) <= tolerance * scale);
  return count;
}

}  // namespace

TEST_CASE("The GPU's rasteriser makes the CPU's maps and gradients of 100,000 surfels") {
  const Results expected = run();
  for_each_gpu_backend([&](const std::string& backend) {
    INFO(backend);
    const HostOrder order(5);
    const bool exact = backend == "kernels on the host";
    for (const auto& [name, values] : run()) {
      INFO(name);
      const bool sum = name.starts_with("gradient") || name == "visibility";
      // The host runs the CPU's text: sums over pixels are taken in another order, all else is the
      // same to the bit. A device contracts products and sums, so that hits at cut-offs (alpha of
      // 1/255, transmittance of 1e-4, the median's 0.5) may come out otherwise, each for a value
      // or two.
      const double tolerance = sum ? 2e-5 : 0;
      const std::vector<float>& other = expected.at(name);
      if (exact)
        CHECK(num_different(values, other, tolerance) == 0);
      else
        CHECK(num_different(values, other, 1e-3) <= values.size() / 500);
    }
    const Results again = run();
    for (const auto& [name, values] : run()) CHECK(values == again.at(name));
  });
}

TEST_CASE("Lists of 100,000 surfels are complete and sorted") {
  const RasterCall call = call_of(scene());
  HostExec exec;
  SplatLists<HostExec> splats;
  const HostOrder order(3);
  splats.make(exec, device_surfels(call.input), camera_of(call), nullptr);
  const OpenMemory open(OpenMemory::kBoth);
  const DeviceLists& lists = splats.lists();
  std::size_t pairs = 0, slots = 0, listed = 0, wrong = 0;
  for (std::size_t i = 0; i < lists.count; ++i) {
    wrong += pairs_of(lists.first[i]) != pairs || lists.first_slot(i) != slots;
    pairs += tiles_of(lists.boxes[i]).count();
    slots += patches_of(lists.boxes[i]).count();
  }
  CHECK(splats.num_pairs(exec) == pairs);
  CHECK(splats.num_slots() == slots);
  CHECK(pairs > 2 * kManySurfels / 3);
  for (int tile = 0; tile < static_cast<int>(splats.num_tiles()); ++tile) {
    const PairRange range = lists.ranges[tile];
    listed += range.end - range.begin;
    for (std::uint32_t k = range.begin; k < range.end; ++k) {
      const std::uint32_t surfel = lists.pairs[k];
      const CellRect rect = tiles_of(lists.boxes[surfel]);
      const int x = lists.tile_x(tile), y = lists.tile_y(tile);
      wrong += x < rect.x0 || x >= rect.x1 || y < rect.y0 || y >= rect.y1;
      if (k == range.begin) continue;
      const std::uint32_t before = lists.pairs[k - 1];
      const float z = lists.splats[surfel].z_center, z_before = lists.splats[before].z_center;
      wrong += !(z_before < z || (z_before == z && before < surfel));  // none twice, either
    }
  }
  CHECK(listed == pairs);
  CHECK(wrong == 0);
}

// For docs/gpu_raster.md: test_glint_cuda_scale "[counts]".
TEST_CASE("Pairs, slots and rows of 100,000 surfels", "[.counts]") {
  use_host_kernels();
  for (const double max_opacity : {1.0, 0.1}) {
    const LargeScene large = large_scene(max_opacity);
    const RasterCall call = call_of(large);
    RasterOutput out;
    for_each_map(
        call.maps(),
        [](const char*, int channels, Image& map) { fit(map, kLargeSize, channels); },
        out
    );
    for (FloatArray* array : {&out.visibility, &out.owned_pixels, &out.radii})
      array->resize(kManySurfels);
    out.in_view.resize(kManySurfels);
    RasterGradient gradient;
    RasterGradient::for_each_array(
        call.maps(),
        [](const char*, std::size_t width, FloatArray& values) {
          values.resize(width * kManySurfels);
        },
        gradient
    );
    HostExec exec;
    RasterPipeline<HostExec> gpu(exec);
    gpu.forward(device_call(call, out));
    const RasterOutputGradient dL_dmaps = gradient_of_maps();
    gpu.backward(device_maps(dL_dmaps), device_gradients(gradient));
    WARN(
        "opacities up to " << max_opacity << ": "
                           << std::count(out.in_view.begin(), out.in_view.end(), 1) << " in view, "
                           << gpu.num_pairs() << " pairs, " << gpu.num_slots() << " slots, "
                           << gpu.num_rows() << " rows"
    );
    CHECK(gpu.num_rows() <= gpu.num_slots());
    CHECK(gpu.num_slots() <= 8 * gpu.num_pairs());
  }
  use_cpu();
}
