// SPDX-License-Identifier: MIT
// The GPU's tracer, its kernels run on the host, against the CPU's.
#include "glint/cuda/trace_pipeline.h"

#include "tests/glint/cuda/trace_parity.h"

using namespace glint;
using namespace glint::test;
using namespace glint::gpu;

TEST_CASE("The GPU's tracer on the host does what the CPU's does") {
  Rng rng(5);
  for (const std::size_t count : {0, 1, 2, 3, 5, 50, 2000}) {
    CAPTURE(count);
    const TraceArrays arrays = random_arrays(count, rng);
    check_as_on_cpu(arrays, random_rays(kParitySize, rng), {});
  }
}

TEST_CASE("The GPU's tracer on the host follows the cut-offs") {
  Rng rng(6);
  TraceArrays arrays = random_arrays(400, rng);
  arrays.surfels.means[30] = std::numeric_limits<float>::quiet_NaN();
  arrays.surfels.opacities[5] = 0;
  TraceSettings settings;
  settings.near = 0.5f;
  settings.min_transmittance = 0.05f;
  settings.max_hits = 7;
  for (const int degree : {0, 1, 2, 3}) {
    CAPTURE(degree);
    arrays.sh_degree = degree;
    check_as_on_cpu(arrays, random_rays(kParitySize, rng), settings);
  }
}

TEST_CASE("The GPU's tracer on the host does what the CPU's does in a room") {
  RoomScene room(5000);
  room.add_large(50);
  room.add_outlier();
  room.add_dead(500);
  check_as_on_cpu(room.arrays, room_rays({48, 27}), {});
  check_as_on_cpu(room.arrays, scattered_rays({48, 27}), {});
}

TEST_CASE("Rays that search again and again find every hit once") {
  Rng rng(7);
  const TraceArrays arrays = random_arrays(800, rng);
  const Rays rays = random_rays(kParitySize, rng);
  check_as_on_cpu<2>(arrays, rays, {});
  check_as_on_cpu<5>(arrays, rays, {});
}

TEST_CASE("Surfels in one place count once each, however many, and a ray has at most max_hits") {
  Rng rng(8);
  TraceArrays arrays;
  for (int i = 0; i < 300; ++i)
    arrays.add({0, 0, 0}, {0.5, 0.5}, {1, 0, 0, 0}, 0.02 + 1e-5 * i, rng);
  for (int i = 0; i < 200; ++i)
    arrays.add({0, 0, 0.5 + 0.01 * i}, {0.5, 0.5}, {1, 0, 0, 0}, 0.02, rng);
  Rays rays{Image(8, 8, 3), Image(8, 8, 3)};
  for (std::size_t i = 0; i < 64; ++i) {
    rays.origins.data()[3 * i] = 0.02f * static_cast<float>(i);
    rays.origins.data()[3 * i + 2] = -2;
    rays.directions.data()[3 * i + 2] = 1;
  }
  check_as_on_cpu(arrays, rays, {});
  TraceSettings more;
  more.max_hits = 400;
  check_as_on_cpu(arrays, rays, more);
  HostExec exec;
  TracePipeline<HostExec> pipeline(exec);
  TraceOutput out = empty_output({8, 8});
  pipeline.forward(device_call({arrays.view(), rays, {}}, out));
  CHECK(pipeline.num_hits() > 15 * 256);  // some rays have all they may have
}

TEST_CASE("Rays are the same as an image and as a list") {
  Rng rng(9);
  const TraceArrays arrays = random_arrays(300, rng);
  const Rays rays = random_rays(kParitySize, rng);
  const TraceCall call{arrays.view(), rays, {}};
  HostExec exec;
  TracePipeline<HostExec> pipeline(exec);
  TraceOutput image = empty_output(kParitySize), list = empty_output(kParitySize);
  pipeline.forward(device_call(call, image));
  DeviceTraceCall as_list = device_call(call, list);
  REQUIRE(as_list.width == kParitySize.width);
  as_list.width = 0;
  pipeline.forward(as_list);
  check_same(list, image, 0);
}

TEST_CASE("Every ray has one place, and 32 in a row are neighbours") {
  const DeviceRays rays{nullptr, nullptr, 23 * 17, 23};
  std::vector<int> places(rays.count);
  for (std::size_t first = 0; first < rays.places(); first += kWarp) {
    std::size_t low = rays.count, high = 0;
    for (std::size_t place = first; place < first + kWarp; ++place) {
      const std::size_t ray = rays.ray(place);
      if (ray >= rays.count) continue;
      ++places[ray];
      low = std::min(low, ray % 23), high = std::max(high, ray % 23);
    }
    CHECK(high < low + 8);
  }
  CHECK(std::all_of(places.begin(), places.end(), [](int n) { return n == 1; }));
}

TEST_CASE("A refitted tree finds surfels where they moved to") {
  Rng rng(8);
  TraceArrays arrays = random_arrays(300, rng);
  const Rays rays = random_rays(kParitySize, rng);
  HostExec exec;
  TracePipeline<HostExec> refitted(exec), fresh(exec);
  TraceOutput a = empty_output(kParitySize), b = a;
  const TraceCall call{arrays.view(), rays, {}};
  refitted.forward(device_call(call, a));
  for (float& value : arrays.surfels.means) value += 0.5f * rng.normal();
  refitted.forward(device_call(call, a));
  fresh.forward(device_call(call, b));
  check_same(a, b, 0);
}

TEST_CASE("A set of the same revision is not looked at again") {
  Rng rng(10);
  TraceArrays arrays = random_arrays(300, rng);
  const Rays rays = random_rays(kParitySize, rng);
  HostExec exec;
  TracePipeline<HostExec> pipeline(exec), fresh(exec);
  TraceOutput first = empty_output(kParitySize), again = first, moved = first, expected = first;
  const auto call = [&](TraceOutput& out, std::uint64_t revision) {
    DeviceTraceCall result = device_call({arrays.view(), rays, {}}, out);
    result.revision = {revision, revision, revision, revision};
    return result;
  };
  pipeline.forward(call(first, 1));
  for (float& value : arrays.surfels.means) value += 0.5f;
  pipeline.forward(call(again, 1));
  check_same(again, first, 0);
  pipeline.forward(call(moved, 2));
  fresh.forward(call(expected, 0));
  check_same(moved, expected, 0);
  CHECK(relative_difference(moved.color.values(), first.color.values()) > 0.1);
}
