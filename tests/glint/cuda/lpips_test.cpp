// SPDX-License-Identifier: MIT
// LPIPS where ops run: the same on a GPU as on the CPU, with targets kept and without, and nothing
// that the host waits for.
#include "metrics/lpips.h"

#include <cmath>

#include "tests/metrics/golden_images.h"
#include "tests/metrics/tiny_lpips.h"
#include "tests/support/gpu_backends.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kWidth = 70, kHeight = 67;

std::shared_ptr<const LpipsWeights> weights_of(const LpipsNetwork& network) {
  return std::make_shared<const LpipsWeights>(
      make_lpips_weights(network, random_arrays(network), network.name)
  );
}
const std::shared_ptr<const LpipsWeights>& tiny_weights() {
  static const auto weights = weights_of(tiny_network());
  return weights;
}

Image rendered_picture() { return golden::prediction_image(kWidth, kHeight, 3); }
// Two that differ.
Image target_picture(int which) {
  Image image = golden::reference_image(kWidth, kHeight, 3);
  for (float& value : image.values()) value = which == 0 ? value : 1 - value;
  return image;
}

// What a few steps over two targets add to a gradient and return.
std::vector<float> run_steps(Lpips& lpips, bool numbered) {
  const Image rendered = rendered_picture();
  const Image targets[2] = {target_picture(0), target_picture(1)};
  Image gradient(kWidth, kHeight, 3, 0.5f);
  std::vector<float> values;
  for (const std::size_t i : {0, 1, 1, 0}) {
    const auto number = numbered ? std::optional(i) : std::nullopt;
    values.push_back(static_cast<float>(lpips.evaluate(rendered, targets[i], 0.3f, gradient, number)
    ));
  }
  values.insert(values.end(), gradient.values().begin(), gradient.values().end());
  return values;
}

}  // namespace

TEST_CASE("LPIPS of every network is on a GPU what own kernels give on the CPU") {
  std::vector<std::shared_ptr<const LpipsWeights>> all{tiny_weights()};
  for (const LpipsNetwork& network : lpips_networks())
    if (network.name != "vgg") all.push_back(weights_of(network));  // no other kind of layer
  check_same_as_cpu(1e-4, [&] {
    std::map<std::string, std::vector<float>> outputs;
    for (const auto& weights : all) {
      Lpips lpips(weights);
      const Image rendered = rendered_picture(), target = target_picture(0);
      Image gradient(kWidth, kHeight, 3);
      const double loss = lpips.evaluate(rendered, target, 0.3f, gradient);
      outputs[weights->network + " gradient"] = read(gradient);
      outputs[weights->network + " loss"] = {static_cast<float>(loss)};
      for (const LpipsMap& map : lpips.tap_maps(rendered, target)) {
        std::vector<float>& maps = outputs[weights->network + " maps"];
        for (const double value : map.values()) maps.push_back(static_cast<float>(value));
      }
    }
    return outputs;
  });
}

TEST_CASE("Targets that are kept change no byte, and serve the other device, too") {
  Lpips with(tiny_weights()), without(tiny_weights());
  const std::vector<float> on_cpu = run_steps(with, true);
  CHECK(with.num_kept_targets() == 2);
  CHECK(run_steps(without, false) == on_cpu);
  CHECK(without.num_kept_targets() == 0);
  for_each_gpu_backend([&](const std::string& backend) {
    INFO(backend);
    Lpips here(tiny_weights());
    const std::vector<float> kept = run_steps(here, true);
    CHECK(here.num_kept_targets() == 2);
    CHECK(run_steps(without, false) == kept);
    CHECK(relative_difference(kept, on_cpu) < 1e-4);
    // Not the same bytes: a GPU rounds otherwise where it fuses products and sums.
    CHECK(relative_difference(run_steps(with, true), on_cpu) < 1e-4);
    CHECK(with.num_kept_targets() == 2);
  });
  CHECK(run_steps(with, true) == on_cpu);
}

TEST_CASE("The network runs once over a target that is kept, every time where there is no room") {
  const OnHost on_host;
  const Image rendered = rendered_picture(), target = target_picture(0);
  Image gradient(kWidth, kHeight, 3);
  const auto launches_again = [&](std::size_t room) {
    host_memory().room = room;
    Lpips lpips(tiny_weights());
    lpips.evaluate(rendered, target, 1, gradient, 0);
    const std::uint64_t before = device_counters.launches;
    lpips.evaluate(rendered, target, 1, gradient, 0);
    host_memory().room = std::size_t{1} << 34;
    return device_counters.launches - before;
  };
  const std::uint64_t kept = launches_again(std::size_t{1} << 30), again = launches_again(1000);
  const std::size_t steps = tiny_weights()->steps.size(), taps = tiny_weights()->lin.size();
  CHECK(again - kept == 1 + steps + taps);  // fed, run, kept for the moment
}

namespace {

// f() in a silent step: it launches kernels, and asks for nothing else.
template <class F>
void check_silent(F&& f) {
  const DeviceCounters before = device_counters;
  {
    const SilentStep silent(true);
    f();
  }
  CHECK(device_counters.launches > before.launches);
  CHECK(device_counters.uploads == before.uploads);
  CHECK(device_counters.downloads == before.downloads);
  CHECK(device_counters.waits == before.waits);
  CHECK(device_counters.allocations == before.allocations);
}

}  // namespace

TEST_CASE("A silent step of LPIPS asks a GPU for nothing and does what any other does") {
  const OnHost on_host;
  const Image rendered = rendered_picture(), target = target_picture(0);
  const bool kept = GENERATE(true, false);
  const auto number = kept ? std::optional<std::size_t>(0) : std::nullopt;
  Lpips lpips(tiny_weights());
  Image gradient(kWidth, kHeight, 3);
  CHECK(std::isfinite(lpips.evaluate(rendered, target, 1, gradient, number)));
  const std::vector<float> told = read(gradient);
  gradient.array().fill(0);
  check_silent([&] { CHECK(std::isnan(lpips.evaluate(rendered, target, 1, gradient, number))); });
  CHECK(read(gradient) == told);
}

TEST_CASE("Pictures of several sizes take turns without asking a GPU for anything") {
  const OnHost on_host;
  struct View {
    Image rendered, target, gradient;
  };
  std::vector<View> views;
  for (const auto& [width, height] : {std::pair{70, 67}, {50, 40}})
    views.push_back(
        {golden::prediction_image(width, height, 3),
         golden::reference_image(width, height, 3),
         Image(width, height, 3)}
    );
  Lpips lpips(tiny_weights());
  const auto evaluate = [&](std::size_t i) {
    views[i].gradient.array().fill(0);
    lpips.evaluate(views[i].rendered, views[i].target, 1, views[i].gradient, i);
  };
  evaluate(0), evaluate(1);
  const std::vector<float> first = read(views[0].gradient), second = read(views[1].gradient);
  check_silent([&] { evaluate(0), evaluate(1); });
  CHECK(read(views[0].gradient) == first);
  CHECK(read(views[1].gradient) == second);
}

TEST_CASE("Pictures of two shapes are an error on a GPU, too") {
  const OnHost on_host;
  Lpips lpips(tiny_weights());
  Image gradient(kWidth, kHeight, 3);
  CHECK_THROWS_AS(
      lpips.evaluate(rendered_picture(), Image(kWidth, kHeight - 1, 3), 1, gradient), Error
  );
}
