// SPDX-License-Identifier: MIT
// Several rasterisations of one set by one camera: they share activation, projection and lists.
#include <catch2/catch.hpp>

#include "glint/cuda/raster_lists.h"
#include "glint/render/shade_kernels.h"
#include "glint/render/void_steps.h"
#include "glint/train/trainable_set.h"
#include "tests/support/count_launches.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/random_scene.h"
#include "tests/support/random_values.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{45, 31};
const Camera kCamera = look_at({0, -3, 0.5}, {0, 0, 0}, {0, 0, 1}, kSize, 70);

RasterOutputGradient noise(std::uint64_t seed) {
  Rng rng(seed);
  RasterOutputGradient g;
  for_each_map(
      {3, true, false},
      [&](const char*, int channels, Image& map) {
        if (channels == 0) return;
        fit(map, kSize, channels);
        for (float& value : map.values()) value = rng.normal();
      },
      g
  );
  return g;
}
RasterSettings with_distortion() {
  RasterSettings settings;
  settings.with_distortion = true;
  return settings;
}

using Bytes = std::vector<float>;
void add_maps(const RasterOutput& out, Bytes& bytes) {
  for_each_map(
      {3, true, false},
      [&](const char*, int, const Image& map) {
        const Bytes values = read(map);
        bytes.insert(bytes.end(), values.begin(), values.end());
      },
      out
  );
  const Bytes visibility = read(out.visibility);
  bytes.insert(bytes.end(), visibility.begin(), visibility.end());
}
void add_gradient(const SurfelCloud& gradient, Bytes& bytes) {
  gradient.for_each_array([&](const char*, const FloatArray& array, std::size_t) {
    const Bytes values = read(array);
    bytes.insert(bytes.end(), values.begin(), values.end());
  });
}

// Behind a near limit, then without: maps and gradients of both, those of the second first, as in a
// step of GLINT. seeing_again: the second pass shares.
struct Step {
  TrainableSet set{ball_of_surfels(300, 11), SetTraining{}};
  RasterPass second;
  Image near{kSize.width, kSize.height, 1, 2.8f};

  Bytes run(bool seeing_again) {
    Bytes bytes;
    add_maps(set.forward(kCamera, 2, {.with_distortion = true}, near), bytes);
    add_maps(
        seeing_again ? set.forward_again(second, set.pass(), with_distortion())
                     : set.forward(second, kCamera, 2, with_distortion()),
        bytes
    );
    set.backward(noise(2), second);
    add_gradient(set.gradient(), bytes);
    set.backward(noise(1));
    add_gradient(set.gradient(), bytes);
    return bytes;
  }
};

}  // namespace

TEST_CASE("Passes that share their lists make the bytes of passes that do not") {
  const Bytes on_cpu = Step().run(false);
  CHECK(Step().run(true) == on_cpu);
  for_each_gpu_backend([&](const std::string& backend) {
    INFO(backend);
    CHECK(Step().run(true) == Step().run(false));
  });
}

TEST_CASE("A pass that sees a set again projects, lists and activates nothing") {
  const OnHost on_host;
  Step step;
  step.run(true);
  const auto launches = [&](const std::type_info& kernel, bool again) {
    const CountedLaunches counted(kernel);
    step.set.cloud().means.device_for_writing();
    step.run(again);
    return counted.count;
  };
  CHECK(launches(typeid(gpu::ProjectSurfels), false) == 2);
  CHECK(launches(typeid(gpu::ProjectSurfels), true) == 1);
  CHECK(launches(typeid(gpu::WritePairs), true) == 1);
  CHECK(launches(typeid(ActivateFeatures), false) == 2);
  CHECK(launches(typeid(ActivateFeatures), true) == 1);
}

TEST_CASE("On the CPU, too, a pass that sees a set again looks at the lists of the first") {
  Step step;
  step.set.forward(kCamera, 2);
  const std::size_t pairs = step.set.num_pairs();
  CHECK(pairs > 0);
  for (float& v : step.set.cloud().means) v += 100;  // not allowed; now nothing is to be seen
  step.set.forward_again(step.second, step.set.pass());
  CHECK(step.second.rasterizer.num_pairs() == pairs);
  step.set.forward(step.second, kCamera, 2);
  CHECK(step.second.rasterizer.num_pairs() == 0);
}

TEST_CASE("On a GPU lists of a set that was written since are not used") {
  const OnHost on_host;
  Step step;
  step.set.forward(kCamera, 2);
  for (float& v : step.set.cloud().means) v += 100;
  step.set.forward_again(step.second, step.set.pass());
  CHECK(step.second.rasterizer.num_pairs() == 0);
}

TEST_CASE("Shared lists without room make the step void, and both passes see nothing") {
  const OnHost on_host;
  Step step;
  SurfelCloud& cloud = step.set.cloud();
  const FloatArray scales = cloud.log_scales;
  for (float& v : cloud.log_scales) v -= 3;
  step.run(true);  // makes room for small ones
  cloud.log_scales = scales;
  const Bytes expected = [&] {
    Step fresh;
    return fresh.run(true);
  }();
  {
    const SilentStep silent(true);
    const RasterOutput& first = step.set.forward(kCamera, 2, {}, step.near);
    const RasterOutput& second = step.set.forward_again(step.second, step.set.pass());
    for (const RasterOutput* out : {&first, &second})
      for (const float alpha : read(out->alpha)) CHECK(alpha == 0);
    end_silent_step();
  }
  CHECK(take_void_steps().count == 1);
  const auto run_from_zero = [&] {
    step.set.load(step.set.cloud());
    return step.run(true);
  };
  CHECK(run_from_zero() == expected);
}
