// SPDX-License-Identifier: MIT
// The GPU's rasteriser and tracer with as many surfels as in training, against the CPU's. Pixels
// are as many, too, but for rays on the host's kernels, which take every seventh or so; a device
// traces all of them, and five times as many surfels.
#include <catch2/catch.hpp>

#include "tests/glint/cuda/check_tree.h"
#include "tests/glint/cuda/trace_parity.h"
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
  settings.with_distortion = settings.with_statistics = true;
  settings.lanes = 1;
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

Results rasterize(const LargeScene& scene) {
  const RasterCall call = call_of(scene);
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

// Of each value from what it should be, over the largest.
std::vector<double> differences(const std::vector<float>& a, const std::vector<float>& b) {
  REQUIRE(a.size() == b.size());
  double scale = 0;
  for (const float v : b) scale = std::max(scale, std::abs(static_cast<double>(v)));
  std::vector<double> found(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    found[i] =
        std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])) / std::max(scale, 1e-20);
  return found;
}

bool is_sum(const std::string& name) {
  return name.starts_with("gradient") || name == "visibility";
}
// What the host's kernels may differ by from the CPU. They are the rasteriser's text: sums over
// pixels are taken in another order, all else is the same to the bit. The tracer's CPU takes rays
// together, and rounds otherwise; gradients of discs seen edge-on, of which there are 2000, are
// small differences of large numbers.
struct Tolerance {
  double maps, sums;
};
constexpr Tolerance kRasterised{0, 2e-5}, kTraced{1e-6, 2e-4};
void check_all_close(const Results& found, const Results& expected, Tolerance tolerance) {
  for (const auto& [name, values] : found) {
    const std::vector<double> all = differences(values, expected.at(name));
    const double allowed = is_sum(name) ? tolerance.sums : tolerance.maps;
    INFO(name << ", at most " << *std::max_element(all.begin(), all.end()));
    CHECK(std::all_of(all.begin(), all.end(), [&](double d) { return d <= allowed; }));
  }
}
// A device contracts products and sums, so that hits at cut-offs (alpha of 1/255, transmittance of
// 1e-4, the median's 0.5) may come out otherwise, each for a value or two.
void check_most_close(const Results& found, const Results& expected) {
  for (const auto& [name, values] : found) {
    INFO(name);
    const std::vector<double> all = differences(values, expected.at(name));
    const auto close = std::count_if(all.begin(), all.end(), [](double d) { return d <= 1e-3; });
    CHECK(values.size() - static_cast<std::size_t>(close) <= values.size() / 500);  // NaN counts
  }
}
// run(): on every backend as on the CPU, and the same bytes each time.
template <class Run>
void check_backends(Tolerance on_host, Run&& run) {
  const Results expected = run();
  for_each_gpu_backend([&](const std::string& backend) {
    INFO(backend);
    const HostOrder order(5);
    const Results found = run();
    if (backend == "kernels on the host")
      check_all_close(found, expected, on_host);
    else
      check_most_close(found, expected);
    CHECK(run() == found);
  });
}

// Rays of the scene's camera, of an image of this size.
Rays rays_of(const LargeScene& scene, ImageSize size) {
  Camera camera = scene.camera;
  const double across = static_cast<double>(size.width) / kLargeSize.width;
  const double down = static_cast<double>(size.height) / kLargeSize.height;
  camera.width = size.width, camera.height = size.height;
  camera.fx *= across, camera.cx *= across;
  camera.fy *= down, camera.cy *= down;
  Rays rays;
  camera_rays(camera, rays);
  return rays;
}
TraceArrays traced_arrays(const LargeScene& scene) {
  Rng rng(4);
  TraceArrays arrays{scene.arrays, {}, {}, 1};
  arrays.sh_dc.resize(3 * scene.arrays.count());
  arrays.sh_rest.resize(45 * scene.arrays.count());
  for (float& v : arrays.sh_dc) v = rng.uniform(-1, 1);
  for (float& v : arrays.sh_rest) v = 0.2f * rng.uniform(-1, 1);
  return arrays;
}

Results trace(const TraceArrays& arrays, const Rays& rays) {
  Tracer tracer;
  const TraceOutput& out = tracer.forward({arrays.view(), rays, {}});
  Results results{
      {"color", read(out.color)},
      {"alpha", read(out.alpha)},
      {"depth", read(out.depth_sum)},
      {"normal", read(out.normal)}};
  Rng rng(5);
  const TraceGradient& gradient = tracer.backward(random_gradient(rays.origins.size(), rng));
  for_each_gradient(gradient, [&](const char* name, std::span<const float> values) {
    results["gradient of " + std::string(name)] = {values.begin(), values.end()};
  });
  return results;
}

}  // namespace

TEST_CASE("The GPU's rasteriser makes the CPU's maps and gradients of 100,000 surfels") {
  check_backends(kRasterised, [] { return rasterize(scene()); });
}

TEST_CASE("The GPU's tracer makes the CPU's maps and gradients of 100,000 surfels") {
  const TraceArrays arrays = traced_arrays(scene());
  const Rays few = rays_of(scene(), {72, 40});
  check_backends(kTraced, [&] { return trace(arrays, few); });
}

TEST_CASE("The tree over 100,000 surfels holds each once, in boxes that hold it") {
  const HostOrder order(3);
  check_tree(traced_arrays(scene()));
}

TEST_CASE("A card makes the CPU's maps and gradients of all rays and of 500,000 surfels") {
  if (!cuda_device().usable) {
    if (gpu_required()) FAIL("no CUDA device: " << cuda_device().why_not);
    return;
  }
  const auto check_on_card = [](auto&& run) {
    const Results expected = run();
    use_cuda();
    const Results found = run();
    check_most_close(found, expected);
    CHECK(run() == found);
    use_cpu();
  };
  const TraceArrays arrays = traced_arrays(scene());
  const Rays all = rays_of(scene(), kLargeSize);
  check_on_card([&] { return trace(arrays, all); });
  const LargeScene more = large_scene(1, 5 * kManySurfels);
  const TraceArrays more_arrays = traced_arrays(more);
  check_on_card([&] { return rasterize(more); });
  check_on_card([&] { return trace(more_arrays, all); });
}

// test_glint_cuda_scale "[large]": minutes.
TEST_CASE("The host's kernels make the CPU's maps and gradients of 500,000 surfels", "[.large]") {
  const LargeScene more = large_scene(1, 5 * kManySurfels);
  const TraceArrays arrays = traced_arrays(more);
  const Rays some = rays_of(more, {120, 68});
  check_tree(arrays);
  check_backends(kRasterised, [&] { return rasterize(more); });
  check_backends(kTraced, [&] { return trace(arrays, some); });
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

// For docs/design/gpu.md: test_glint_cuda_scale "[counts]".
TEST_CASE("Pairs, slots and rows of 100,000 surfels", "[.counts]") {
  const OnHost on_host;
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
}
