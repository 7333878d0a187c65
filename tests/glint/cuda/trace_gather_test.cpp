// SPDX-License-Identifier: MIT
// The way back through the GPU's tracer: sums over hits, their order, their memory.
#include "tests/glint/cuda/trace_parity.h"
#include "tests/support/gpu_backends.h"

using namespace glint;
using namespace glint::test;
using namespace glint::gpu;

namespace {

std::vector<float> gradient_in_order(const TraceCall& call, std::uint64_t seed) {
  const ImageSize size{call.rays.origins.width(), call.rays.origins.height()};
  Rng rng(4);
  const TraceOutputGradient g = random_gradient(size, rng);
  const HostOrder in_order(seed);
  HostExec exec;
  TracePipeline<HostExec> pipeline(exec);
  TraceOutput out = empty_output(size);
  pipeline.forward(device_call(call, out));
  TraceGradient gradient = unset_gradient(call.input.count, size);
  pipeline.backward(device_output(g), device_gradients(gradient));
  return all_values(gradient);
}

// Surfels that every ray meets, between others.
TraceArrays with_large(Rng& rng) {
  TraceArrays arrays = random_arrays(100, rng);
  for (int i = 0; i < 5; ++i)
    arrays.add({0, 0, 0.3 * i}, {9, 9}, random_unit_quaternion(rng), 0.05 + 0.1 * i, rng);
  return arrays;
}

}  // namespace

TEST_CASE("Gradients of the GPU's tracer are the same bytes in whatever order threads run") {
  Rng rng(11);
  const TraceArrays arrays = with_large(rng);
  const Rays rays = random_rays({64, 50}, rng);
  const TraceCall call{arrays.view(), rays, {}};
  const std::vector<float> expected = gradient_in_order(call, 1);
  for (const std::uint64_t seed : {2, 3}) CHECK(gradient_in_order(call, seed) == expected);
}

TEST_CASE("Surfels with more hits than a warp sums alone get the CPU's gradient") {
  Rng rng(12);
  const TraceArrays arrays = with_large(rng);
  check_as_on_cpu(arrays, random_rays({80, 61}, rng), {});
}

TEST_CASE("Gradients may be asked for without some of the outputs") {
  Rng rng(13);
  const TraceArrays arrays = random_arrays(200, rng);
  const Rays rays = random_rays(kParitySize, rng);
  const TraceCall call{arrays.view(), rays, {}};
  TraceOutputGradient g = random_gradient(kParitySize, rng);
  g.normal = {};
  g.alpha = {};
  Tracer cpu;
  cpu.forward(call);
  HostExec exec;
  TracePipeline<HostExec> pipeline(exec);
  TraceOutput out = empty_output(kParitySize);
  pipeline.forward(device_call(call, out));
  TraceGradient gradient = unset_gradient(call.input.count, kParitySize);
  pipeline.backward(device_output(g), device_gradients(gradient));
  check_same(gradient, cpu.backward(g), kSumsInAnotherOrder);
}

namespace {

// Counts what the host waits for.
class WatchedExec : public HostExec {
 public:
  template <class T>
  using Buffer = HostExec::Buffer<T>;
  template <class T>
  void download(const Buffer<T>& from, std::size_t count, T* to) {
    ++waits;
    HostExec::download(from, count, to);
  }
  int waits = 0;
};

// `layers` surfels that each ray of an image meets.
struct Layers {
  explicit Layers(int layers, ImageSize size) : rays{Image(size.width, size.height, 3), {}} {
    Rng rng(14);
    for (int i = 0; i < layers; ++i)
      arrays.add({0, 0, 1 + 0.01 * i}, {5, 5}, {1, 0, 0, 0}, 0.01, rng);
    rays.directions = Image(size.width, size.height, 3);
    for (std::size_t i = 0; i < size.num_pixels(); ++i) rays.directions.data()[3 * i + 2] = 1;
  }
  TraceCall call() const { return {arrays.view(), rays, {}}; }
  TraceArrays arrays;
  Rays rays;
};

struct Calls {
  WatchedExec exec;
  TracePipeline<WatchedExec> pipeline{exec};
  TraceOutput out;
  TraceGradient gradient;
  std::uint32_t dropped_hits = 0;

  void run(const Layers& scene) {
    const ImageSize size{scene.rays.origins.width(), scene.rays.origins.height()};
    Rng rng(15);
    const TraceOutputGradient g = random_gradient(size, rng);
    out = empty_output(size);
    gradient = unset_gradient(scene.arrays.surfels.count(), size);
    DeviceTraceCall call = device_call(scene.call(), out);
    call.overflow = &dropped_hits;
    pipeline.forward(call);
    pipeline.backward(device_output(g), device_gradients(gradient));
  }
};

}  // namespace

TEST_CASE("A silent trace waits for nothing and gives the same") {
  const OnHost on_host;
  const Layers scene(40, {16, 12});
  Calls loud, silent;
  loud.run(scene);
  CHECK(loud.exec.waits > 0);
  silent.run(scene);
  silent.exec.waits = 0;
  const std::vector<float> before = all_values(silent.gradient);
  {
    const SilentStep step(true);
    silent.run(scene);
  }
  CHECK(silent.exec.waits == 0);
  CHECK(silent.dropped_hits == 0);
  CHECK(all_values(silent.gradient) == before);
  CHECK(all_values(silent.gradient) == all_values(loud.gradient));
}

TEST_CASE("The first trace of all makes room, in a silent step, too") {
  const OnHost on_host;
  const Layers many(150, {16, 12});
  Calls loud, silent;
  loud.run(many);
  {
    const SilentStep step(true);
    silent.run(many);
    CHECK(silent.dropped_hits == 0);
    CHECK(all_values(silent.gradient) == all_values(loud.gradient));
    silent.exec.waits = 0;
    silent.run(many);
  }
  CHECK(silent.exec.waits == 0);
  CHECK(silent.dropped_hits == 0);
  CHECK(all_values(silent.gradient) == all_values(loud.gradient));
}

TEST_CASE("Where silent traces have more hits than room, they say so; others make room") {
  const OnHost on_host;
  const Layers few(20, {16, 12}), many(150, {16, 12});
  Calls calls, again, loud;
  for (Calls* c : {&calls, &again}) {
    c->run(few);
    {
      const SilentStep step(true);
      c->run(many);
    }
    CHECK(c->dropped_hits == 1);
  }
  CHECK(all_values(calls.gradient) == all_values(again.gradient));
  CHECK(std::all_of(calls.gradient.means.begin(), calls.gradient.means.end(), [](float v) {
    return std::isfinite(v);
  }));
  loud.run(many);
  CHECK(loud.pipeline.num_hits() == std::size_t{150} * 16 * 12);
  calls.run(many);
  CHECK(all_values(calls.gradient) == all_values(loud.gradient));
}

TEST_CASE("Hits that have no room in a silent gradient are missing there and nowhere else") {
  const OnHost on_host;
  const Layers few(20, {16, 12}), more(60, {16, 12});
  Calls calls, loud;
  calls.run(few);
  {
    const SilentStep step(true);
    calls.run(more);
  }
  CHECK(calls.pipeline.num_hits() == std::size_t{60} * 16 * 12);
  loud.run(more);
  CHECK(
      relative_difference(
          calls.gradient.rays.origins.values(), loud.gradient.rays.origins.values()
      ) == 0
  );
  const auto hits_of = [](const TraceGradient& g) {
    return std::accumulate(g.visibility.begin(), g.visibility.end(), 0.0);
  };
  CHECK(hits_of(calls.gradient) < 0.9 * hits_of(loud.gradient));
  CHECK(calls.dropped_hits == 1);
  calls.run(more);
  CHECK(all_values(calls.gradient) == all_values(loud.gradient));
}
