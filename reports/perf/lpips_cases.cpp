// SPDX-License-Identifier: MIT
// LPIPS as a loss, which costs what its network costs: of VGG16, by far the largest, with random
// weights, of a target that is kept. On a GPU alone: on the CPU it would take longer than all else.
#include <cmath>
#include <memory>

#include "glint/core/rng.h"
#include "metrics/lpips.h"
#include "reports/perf/perf_scene.h"

namespace glint {

namespace {

LpipsArray random_weights(Rng& rng, const std::vector<int>& shape, float low, float high) {
  LpipsArray array{{shape.begin(), shape.end()}, {}};
  std::size_t count = 1;
  for (const std::size_t extent : array.shape) count *= extent;
  array.values.resize(count);
  for (float& value : array.values) value = rng.uniform(low, high);
  return array;
}

// Of a network of convolutions and poolings; features neither grow nor die out on the way.
LpipsWeights random_lpips_weights(const LpipsNetwork& network) {
  Rng rng(1);
  LpipsArrays arrays;
  int channels = 3, num_taps = 0;
  for (const LpipsLayer& layer : network.layers) {
    if (layer.pools()) continue;
    const int kernel = layer.kernel;
    const float bound = std::sqrt(6.0f / static_cast<float>(channels * kernel * kernel));
    arrays[layer.name + ".weight"] =
        random_weights(rng, {layer.channels, channels, kernel, kernel}, -bound, bound);
    arrays[layer.name + ".bias"] = random_weights(rng, {layer.channels}, 0, 0.1f);
    channels = layer.channels;
    if (layer.tap)
      arrays[fmt::format("lin{}.weight", num_taps++)] = random_weights(rng, {channels}, 0, 1);
  }
  return make_lpips_weights(network, arrays, "perf");
}

PerfCase lpips_case(
    const std::string& name, const LpipsNetwork& network, const PerfOptions& options
) {
  struct State {
    Image rendered, target, gradient;
    Lpips lpips;
    explicit State(const LpipsNetwork& of)
        : lpips(std::make_shared<const LpipsWeights>(random_lpips_weights(of))) {}
  };
  const auto s = std::make_shared<State>(network);
  s->target = perf_scene(options).train.front().rgb;
  s->rendered = Image(options.width, options.height, 3, 0.4f);
  s->gradient = Image(options.width, options.height, 3);
  return {
      name,
      "pixels",
      [s] { return static_cast<double>(s->target.num_pixels()); },
      [s] { s->lpips.evaluate(s->rendered, s->target, 1, s->gradient, 0); },
      {}};
}

std::vector<PerfCase> lpips_cases(const PerfOptions& options) {
  const std::string name = "LPIPS with gradient, VGG16";
  if (!on_gpu() || !options.wants(name)) return {};
  for (const LpipsNetwork& network : lpips_networks())
    if (network.name == "vgg") return {lpips_case(name, network, options)};
  return {};
}

}  // namespace

GLINT_REGISTER(PerfCases, {"lpips", lpips_cases})

}  // namespace glint
