// SPDX-License-Identifier: MIT
// The GPU's rasteriser, its kernels run on the host, against the CPU's.
#include <catch2/catch.hpp>

#include "glint/cuda/ops.h"
#include "tests/support/gpu_backends.h"
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

struct Case {
  ImageSize size;
  int surfels, channels;
  bool distortion, near_limit, plane_distance, statistics;
  bool surface = true;
};
const Case kCases[] = {
    {{1, 1}, 5, 3, false, false, true, true},
    {{16, 16}, 30, 3, true, false, false, false},
    {{17, 33}, 200, 5, true, true, true, false},
    {{50, 31}, 700, 4, false, true, true, true},
    {{33, 31}, 300, 7, false, true, true, true},
    {{20, 41}, 300, 6, true, false, false, false},
    {{70, 40}, 1500, 3, true, false, false, true},
    {{40, 33}, 400, 3, false, true, false, false, false},
    {{40, 33}, 400, 4, false, true, false, false, false},
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
    settings.with_surface = c.surface;
    settings.lanes = 1;
    input = arrays.view();
    if (c.near_limit) input.near_limit = near_limit;
  }
  RasterCall call() const { return {input, camera, settings}; }
};

RasterOutputGradient random_gradient(const Case& c, std::uint64_t seed) {
  Rng rng(seed);
  RasterOutputGradient gradient = room(c.size, c.channels, 0);
  for_each_map(
      {c.channels, true, true},
      [&](const char*, int, Image& map) {
        for (float& value : map.values()) value = rng.normal();
      },
      gradient
  );
  return gradient;
}

// Room for everything, full of numbers that are to be overwritten.
RasterGradient gradient_room(const Case& c) {
  RasterGradient gradient;
  RasterGradient::for_each_array(
      {c.channels, true, true, true},
      [&](const char*, std::size_t width, FloatArray& values) {
        values.assign(width * static_cast<std::size_t>(c.surfels), -1.0f);
      },
      gradient
  );
  if (!c.statistics) gradient.screen_abs.clear();
  return gradient;
}

using Bytes = std::vector<float>;
void append(std::span<const float> values, Bytes& all) {
  all.insert(all.end(), values.begin(), values.end());
}

// All that a pass forward and back writes.
Bytes run_both_ways(
    RasterPipeline<HostExec>& gpu,
    const Fixture& f,
    const Case& c,
    std::uint32_t* overflow = nullptr,
    RasterPipeline<HostExec>* other = nullptr
) {
  RasterOutput maps = room(c.size, c.channels, f.arrays.count());
  RasterGradient gradient = gradient_room(c);
  DeviceRasterCall call = device_call(f.call(), maps);
  call.overflow = overflow;
  gpu.forward(call, other);
  const RasterOutputGradient dL_dmaps = random_gradient(c, 5);
  gpu.backward(device_maps(dL_dmaps), device_gradients(gradient));
  Bytes all;
  for_each_map(
      f.call().maps(),
      [&](const char*, int channels, const Image& map) {
        if (channels > 0) append(map.values(), all);
      },
      maps
  );
  append(maps.visibility, all);
  if (c.statistics) append(maps.owned_pixels, all);
  RasterGradient::for_each_array(
      f.call().maps(),
      [&](const char*, std::size_t, const FloatArray& values) { append(values, all); },
      gradient
  );
  return all;
}

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
          if (channels > 0) CHECK(relative_difference(a.values(), b.values()) == 0);
        },
        actual,
        expected
    );
    CHECK(relative_difference(actual.visibility, expected.visibility) < 1e-5);
    if (!c.statistics) continue;
    CHECK(relative_difference(actual.owned_pixels, expected.owned_pixels) == 0);
    CHECK(relative_difference(actual.radii, expected.radii) == 0);
  }
}

TEST_CASE("The GPU's rasteriser on the host finds the CPU's modes of depth") {
  std::uint64_t seed = 1;
  for (const Case& c : kCases) {
    CAPTURE(c.size.width, c.surfels);
    const Fixture f(c, seed++);
    Rasterizer cpu;
    cpu.forward(f.call());
    Image expected_first, expected_last;
    cpu.depth_modes({}, expected_first, expected_last);
    HostExec exec;
    RasterPipeline<HostExec> gpu(exec);
    RasterOutput maps = room(c.size, c.channels, f.arrays.count());
    gpu.forward(device_call(f.call(), maps));
    Image first(c.size.width, c.size.height, 1), last = first;
    gpu.depth_modes({}, first.on_device(), last.on_device());
    CHECK(relative_difference(first.values(), expected_first.values()) == 0);
    CHECK(relative_difference(last.values(), expected_last.values()) == 0);
  }
}

TEST_CASE("The GPU's rasteriser on the host makes the CPU's gradients") {
  std::uint64_t seed = 11;
  for (const Case& c : kCases) {
    CAPTURE(c.size.width, c.surfels);
    const Fixture f(c, seed++);
    RasterOutput maps = room(c.size, c.channels, f.arrays.count());
    const RasterOutputGradient dL_doutput = random_gradient(c, seed);
    Rasterizer cpu;
    cpu.forward(f.call());
    const RasterGradient& expected = cpu.backward(dL_doutput);
    RasterGradient actual = gradient_room(c);
    HostExec exec;
    RasterPipeline<HostExec> gpu(exec);
    gpu.forward(device_call(f.call(), maps));
    gpu.backward(device_maps(dL_doutput), device_gradients(actual));
    RasterGradient::for_each_array(
        {},
        [](const char* name, std::size_t, const FloatArray& a, const FloatArray& b) {
          INFO(name);
          CHECK(relative_difference(a, b) < 2e-5);  // sums over pixels in another order
        },
        actual,
        expected
    );
  }
}

TEST_CASE("The GPU's rasteriser gives the same bytes in any order of threads, warps and blocks") {
  std::uint64_t seed = 21;
  for (const Case& c : kCases) {
    CAPTURE(c.size.width, c.surfels);
    const Fixture f(c, seed++);
    std::vector<Bytes> results;
    for (const std::uint64_t order : {0, 1, 2, 3}) {
      const HostOrder in_order(order);
      HostExec exec;
      RasterPipeline<HostExec> gpu(exec);
      results.push_back(run_both_ways(gpu, f, c));
    }
    for (const Bytes& result : results) CHECK(result == results[0]);
  }
}

TEST_CASE("Silent steps of the GPU's rasteriser wait for nothing and give the bytes of loud ones") {
  const OnHost on_host;
  const Case& c = kCases[3];
  const Fixture f(c, 31);
  HostExec exec;
  RasterPipeline<HostExec> gpu(exec);
  std::uint32_t overflow = 0;
  {  // without a call before it that waited there is no room: it waits, too
    const SilentStep silent(true);
    const Bytes first = run_both_ways(gpu, f, c, &overflow);
    RasterPipeline<HostExec> fresh(exec);
    const SilentStep loud(false);
    CHECK(run_both_ways(fresh, f, c) == first);
  }
  const Bytes expected = run_both_ways(gpu, f, c, &overflow);
  const std::size_t pairs = gpu.num_pairs(), slots = gpu.num_slots();
  const SilentStep silent(true);
  CHECK(run_both_ways(gpu, f, c, &overflow) == expected);
  CHECK(gpu.num_slots() == slots + slots / 2);
  CHECK(gpu.num_pairs() == pairs);
  CHECK(overflow == 0);
}

TEST_CASE("Where a silent step of the GPU's rasteriser lacks room, it says so and shows nothing") {
  const OnHost on_host;
  const Case& small = kCases[3];
  Case large = small;
  large.surfels *= 3;
  const Fixture few(small, 41), many(large, 41);
  HostExec exec;
  RasterPipeline<HostExec> gpu(exec);
  const Bytes expected = run_both_ways(gpu, many, large);
  RasterPipeline<HostExec> learned(exec);
  run_both_ways(learned, few, small);
  std::uint32_t overflow = 0;
  {
    const SilentStep silent(true);
    const Bytes nothing = run_both_ways(learned, many, large, &overflow);
    CHECK(std::all_of(nothing.begin(), nothing.end(), [](float v) { return v == 0; }));
    CHECK(overflow == 1);
    run_both_ways(learned, few, small, &overflow);
    CHECK(overflow == 1);  // stays until its owner clears it
    CHECK(learned.num_pairs() < gpu.num_pairs());
  }
  CHECK(run_both_ways(learned, many, large, &overflow) == expected);
  const SilentStep silent(true);
  overflow = 0;
  CHECK(run_both_ways(learned, many, large, &overflow) == expected);
  CHECK(overflow == 0);
}

TEST_CASE("Where only the gradients lack room, they are zero") {
  const OnHost on_host;
  const Case& c = kCases[3];
  const Fixture f(c, 51);
  Fixture hidden(c, 51);  // the same pairs without any hit
  for (float& z : hidden.near_limit.values()) z = 1e6f;
  hidden.input.near_limit = hidden.near_limit;
  HostExec exec;
  RasterPipeline<HostExec> gpu(exec), fresh(exec);
  const Bytes expected = run_both_ways(fresh, f, c);
  run_both_ways(gpu, hidden, c);
  std::uint32_t overflow = 0;
  const SilentStep silent(true);
  const Bytes found = run_both_ways(gpu, f, c, &overflow);
  CHECK(overflow == 1);
  std::size_t gradients = 0;
  RasterGradient::for_each_array(f.call().maps(), [&](const char*, std::size_t width) {
    gradients += width * static_cast<std::size_t>(c.surfels);
  });
  const std::size_t maps = expected.size() - gradients;
  CHECK(std::equal(
      expected.begin(), expected.begin() + static_cast<std::ptrdiff_t>(maps), found.begin()
  ));
  CHECK(std::all_of(found.begin() + static_cast<std::ptrdiff_t>(maps), found.end(), [](float v) {
    return v == 0;
  }));
}

TEST_CASE("Counts of pairs that are too large for 32 bits stay at the largest number, each alone") {
  const AddPairCounts add;
  const PairCounts large = pair_counts(0xc0000000u, 5), sum = add(large, large);
  CHECK(pairs_of(sum) == 0xffffffffu);
  CHECK(slots_of(sum) == 10);
  CHECK(add(sum, pair_counts(7, 1)) == pair_counts(0xffffffffu, 11));
  CHECK(slots_of(add(pair_counts(1, 0x80000000u), pair_counts(1, 0x80000000u))) == 0xffffffffu);
  CHECK(add(pair_counts(1, 2), pair_counts(3, 4)) == pair_counts(4, 6));
}

TEST_CASE("More pairs than the GPU can list are an error, and make a silent step void") {
  const OnHost on_host;
  HostExec exec;
  CountedRoom<HostExec> counted;
  const auto count = [&](std::vector<PairCounts> counts, std::uint32_t* overflow) {
    HostExec::Buffer<PairCounts> buffer;
    buffer.resize(counts.size());
    {
      const OpenMemory open(OpenMemory::kBoth);
      std::copy(counts.begin(), counts.end(), buffer.data());
    }
    return counted.count(exec, buffer, counts.size(), {640, 480}, overflow);
  };
  const PairCounts many_pairs = pair_counts(0x40000000u, 1);
  const PairCounts many_slots = pair_counts(1, kMostPairs.slots);
  CHECK(count({many_slots}, nullptr).slots == kMostPairs.slots);
  for (const PairCounts many : {many_pairs, many_slots}) {
    CHECK_THROWS_WITH(
        count({many, many}, nullptr),
        Catch::Matchers::Contains("2 surfels") && Catch::Matchers::Contains("640x480")
    );
    std::uint32_t overflow = 0;
    const SilentStep silent(true);
    count({many, many}, &overflow);
    CHECK(overflow == 1);
  }
}

TEST_CASE("A second pass of the GPU's rasteriser over the same surfels uses the lists of the first"
) {
  const Case& c = kCases[2];
  const Fixture behind(c, 61);
  Fixture alone(c, 61);
  alone.input = behind.input;  // the same arrays
  alone.input.near_limit = {};
  HostExec exec;
  RasterPipeline<HostExec> first(exec), second(exec), apart(exec);
  const Bytes expected_behind = run_both_ways(first, behind, c);
  const Bytes expected_alone = run_both_ways(apart, alone, c);
  CHECK(expected_behind != expected_alone);
  CHECK(run_both_ways(second, alone, c, nullptr, &first) == expected_alone);
  CHECK(!second.has_own_lists());
  RasterPipeline<HostExec> third(exec);  // by way of the second
  CHECK(run_both_ways(third, behind, c, nullptr, &second) == expected_behind);
  CHECK(!third.has_own_lists());

  alone.camera.fx *= 1.5;  // another view
  const Bytes other_view = run_both_ways(apart, alone, c);
  CHECK(run_both_ways(second, alone, c, nullptr, &first) == other_view);
  CHECK(second.has_own_lists());
  const Fixture other(c, 62);  // other surfels
  CHECK(run_both_ways(second, other, c, nullptr, &first) == run_both_ways(apart, other, c));
  CHECK(second.has_own_lists());
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
