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

// The bytes of a training in which the host is told everything.
std::string saved_when_told(const std::string& id, const Scene& scene) {
  const auto method = create_method(id);
  train_silently(*method, scene, kEnd);
  return saved_bytes(*method);
}

struct Steady {
  std::uint64_t launches = 0;  // of a step
  std::string bytes;           // at the end
};

Steady check_steady(const std::string& id, const Scene& scene) {
  INFO(id);
  const auto method = create_method(id);
  const Costs costs = train_silently(*method, scene, kSilentFrom);
  CHECK(costs.steps == kEnd - kSteady);
  CHECK(costs.counters.uploads == 0);
  CHECK(costs.counters.downloads == 0);
  CHECK(costs.counters.waits == 0);
  CHECK(costs.counters.allocations == 0);
  CHECK(costs.counters.launches > 10 * (kEnd - kSteady));
  CHECK(take_void_steps().count == 0);
  return {costs.counters.launches / (kEnd - kSteady), saved_bytes(*method)};
}

}  // namespace

TEST_CASE("A steady step asks a GPU for nothing and changes no byte, whatever the method") {
  const OnHost on_host;
  const LpipsWeightsHere weights;  // for those that look at LPIPS
  const Scene scene = two_views_of_room();
  for (const std::string& id : all_trained()) {
    INFO(id);
    const Steady steady = check_steady(id, scene);
    CHECK((steady.bytes == saved_when_told(id, scene)));
  }
}

TEST_CASE("LPIPS is a network more in a steady step") {
  const OnHost on_host;
  const Scene scene = two_views_of_room();
  const std::uint64_t without = check_steady("envgs", scene).launches;
  const LpipsWeightsHere weights;
  CHECK(check_steady("envgs", scene).launches > without + 10);  // there and back
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
