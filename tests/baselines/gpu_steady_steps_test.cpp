// SPDX-License-Identifier: MIT
// A steady step on a GPU: the host asks for nothing and gets no memory, and computes what any other
// step does. On the host's kernels, whose counters are those of a device.
#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "glint/method.h"
#include "glint/render/void_steps.h"
#include "glint/train/neighbor_views.h"
#include "glint/train/trainer.h"
#include "tests/support/all_trained.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/lpips_weights_here.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

// So short that density control is not due, and all losses are there in the end. The first steps
// are the CPU's, which is faster than kernels on the host; two that are told everything make room,
// one of them of those whose gradients growth counts (MirrorCutoffs::observes).
constexpr int kPlanned = 24, kOnCpu = 16, kSilentFrom = 18, kSteady = 20, kEnd = 22;

// Neighbours, so that losses between two views are among what is counted.
Scene two_views_of_room() {
  Scene scene = small_room();
  NeighborConfig neighbors;
  neighbors.max_distance = 100;
  const std::size_t second = neighbor_views(scene.train, neighbors, 1).at(0).at(0);
  scene.train = {scene.train[0], scene.train[second]};
  return scene;
}
// As if every view had been trained on before.
void bring_to_device(const Scene& scene) {
  for (const View& view : scene.train) {
    view.rgb.array().device_for_reading();
    for (const MapSet* maps : {&view.priors, &view.truth})
      maps->for_each([](const MapRow&, const Image& map) { map.array().device_for_reading(); });
  }
}

struct Costs {
  DeviceCounters counters;
  int steps = 0;
  DeviceCounters before = device_counters;
  void add() {
    const DeviceCounters& now = device_counters;
    DeviceCounters::for_each(
        [](const char*, std::uint64_t& sum, std::uint64_t after, std::uint64_t earlier) {
          sum += after - earlier;
        },
        counters,
        now,
        before
    );
    ++steps;
  }
};

// Trains to the end, with silent steps from `silent_from` on; the cost of the last ones.
Costs train_silently(Method& method, const Scene& scene, int silent_from) {
  use_cpu();
  method.initialize(scene, {kPlanned, 0});
  for (int i = 0; i < kOnCpu; ++i) method.step(i);
  use_host_kernels();
  bring_to_device(scene);
  watch_memory(false);
  Costs costs;
  for (int i = kOnCpu; i < kEnd; ++i) {
    if (i == kSteady) watch_memory(true);
    const SilentStep silent(i >= silent_from);
    costs.before = device_counters;
    method.step(i);
    end_silent_step();
    if (i >= kSteady) costs.add();
  }
  return costs;
}

std::string saved_after(const std::string& id, const Scene& scene, int silent_from) {
  const auto method = create_method(id);
  train_silently(*method, scene, silent_from);
  return saved_bytes(*method);
}

// The launches of a step.
std::uint64_t check_steady(const std::string& id) {
  INFO(id);
  const Scene scene = two_views_of_room();
  const auto method = create_method(id);
  const Costs costs = train_silently(*method, scene, kSilentFrom);
  CHECK(costs.steps == kEnd - kSteady);
  CHECK(costs.counters.uploads == 0);
  CHECK(costs.counters.downloads == 0);
  CHECK(costs.counters.waits == 0);
  CHECK(costs.counters.allocations == 0);
  CHECK(costs.counters.launches > 10 * (kEnd - kSteady));
  CHECK(take_void_steps().count == 0);
  return costs.counters.launches / (kEnd - kSteady);
}

}  // namespace

TEST_CASE("A steady step asks a GPU for nothing, whatever the method") {
  const OnHost on_host;
  for (const std::string& id : all_trained()) check_steady(id);
}

TEST_CASE("Nor does a steady step with LPIPS") {
  const OnHost on_host;
  const std::uint64_t without = check_steady("envgs");
  const LpipsWeightsHere weights;
  CHECK(check_steady("envgs") > without + 10);  // a network, there and back
  for (const char* id : {"glint/release", "rt-splatting"}) check_steady(id);
}

// For docs/design/gpu.md: test_baselines_gpu_steady_steps "[costs]".
TEST_CASE("What a steady step asks of a GPU", "[.costs]") {
  const OnHost on_host;
  for (const std::string& id : all_trained()) {
    const Scene scene = two_views_of_room();
    const auto method = create_method(id);
    const Costs costs = train_silently(*method, scene, kSilentFrom);
    fmt::print("| {} ", id);
    DeviceCounters::for_each(
        [&](const char*, std::uint64_t count) {
          fmt::print("| {} ", count / static_cast<std::uint64_t>(costs.steps));
        },
        costs.counters
    );
    fmt::print("|\n");
  }
}

TEST_CASE("A training of silent steps ends with the bytes of one that is told everything") {
  const OnHost on_host;
  const LpipsWeightsHere weights;  // for those that look at LPIPS
  const Scene scene = two_views_of_room();
  for (const std::string& id : all_trained()) {
    INFO(id);
    const std::string told = saved_after(id, scene, kEnd);
    const std::string silent = saved_after(id, scene, kSilentFrom);
    CHECK(take_void_steps().count == 0);
    CHECK((told == silent));
  }
}

TEST_CASE("What a training had in use on a device at most is told, and is 0 on the CPU") {
  const auto memory_of_training = [] {
    const Scene scene = small_room();
    const auto method = create_method("2dgs");
    TrainOptions options;
    options.run.iterations = 4;
    reset_device_peak();
    return train(*method, scene, options).device_memory_mb;
  };
  CHECK(memory_of_training() == 0);
  const OnHost on_host;
  watch_memory(false);
  const double first = memory_of_training();
  const double photo_mb = 4e-6 * static_cast<double>(small_room().train[0].rgb.values().size());
  CHECK(first > photo_mb);
  CHECK(memory_of_training() == first);  // the one before has left
}

TEST_CASE("Images that fill more than half of a device come for a step and leave, or stay") {
  const OnHost on_host;
  watch_memory(false);
  const auto train_with = [](std::size_t room) {
    host_memory().room = room;
    Scene scene = small_room();
    scene.train.resize(3);
    const auto method = create_method("2dgs");
    const std::uint64_t before = device_counters.uploads;
    TrainOptions options;
    options.run.iterations = 12;
    train(*method, scene, options);
    return std::pair{saved_bytes(*method), device_counters.uploads - before};
  };
  const auto large = train_with(std::size_t{1} << 34), small = train_with(1000);
  CHECK(large.first == small.first);
  CHECK(small.second >= large.second + 9);  // each step's photo, not each view's
  host_memory().room = std::size_t{1} << 34;
}
