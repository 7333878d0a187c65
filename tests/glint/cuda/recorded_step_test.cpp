// SPDX-License-Identifier: MIT
// Steps that a device gets as one: on the host's kernels, and as graphs on a card.
#include "glint/core/recorded_step.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "glint/render/void_steps.h"
#include "glint/train/trainable_set.h"
#include "tests/support/gpu_backends.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kSteps = 12;

SurfelCloud row_of_surfels() {
  SurfelCloud cloud;
  cloud.resize(30);
  for (std::size_t i = 0; i < 30; ++i) {
    const float at[3] = {0.05f * static_cast<float>(i) - 0.7f, 0.1f, 2};
    std::copy_n(at, 3, &cloud.means[3 * i]);
    cloud.rotations[4 * i] = 1;
    cloud.log_scales[2 * i] = cloud.log_scales[2 * i + 1] = std::log(0.1f);
    cloud.sh_dc[3 * i] = 0.03f * static_cast<float>(i);
  }
  return cloud;
}

Camera camera() {
  Camera camera;
  camera.width = camera.height = 21;
  camera.fx = camera.fy = 20;
  camera.cx = camera.cy = 10.5;
  return camera;
}

// Pulls alpha and colour up. Where ops run already: what is brought there ends a recording.
RasterOutputGradient upwards() {
  RasterOutputGradient dL;
  dL.alpha = Image(21, 21, 1, -0.01f);
  dL.features = Image(21, 21, 3, -0.02f);
  for (const Image* map : {&dL.alpha, &dL.features}) map->array().device_for_reading();
  return dL;
}

// `passes` times, so that steps have several shapes.
void step(TrainableSet& set, const RasterOutputGradient& dL, int i, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    set.forward(camera(), 1);
    set.backward(dL);
  }
  set.update(i + 1);
}

// `look_at`: a step in which the host looks at an array.
std::vector<float> train(int look_at = -1) {
  TrainableSet set(row_of_surfels(), SetTraining{});
  const RasterOutputGradient dL = upwards();
  step(set, dL, 0, 3);  // makes room, as steps that are not silent do
  for (int i = 1; i < kSteps; ++i) {
    const SilentStep silent(true);
    RecordedStep recorded;
    step(set, dL, i, i % 4 == 3 ? 2 : 1);
    if (i == look_at) CHECK(std::isfinite(set.cloud().means[0]));
    end_silent_step();
    recorded.end();
  }
  return read(set.cloud().means);
}

// f(record) with each GPU backend; record(bool): whether its silent steps are recorded.
template <class F>
void for_each_recorder(F&& f) {
  for_each_gpu_backend([&](const std::string& backend) {
    INFO(backend);
    const bool host = backend == "kernels on the host";
    f([host](bool recorded) { host ? use_host_kernels(recorded) : gpu::use_graphs(recorded); });
    step_recorder = nullptr;
  });
}

}  // namespace

TEST_CASE("Recorded steps compute what others do, whatever their shapes") {
  for_each_recorder([](auto&& record) {
    record(false);
    const std::vector<float> expected = train();
    record(true);
    const std::uint64_t kept = host_recorder().kept, interrupted = host_recorder().interrupted;
    CHECK(train() == expected);
    if (step_recorder == &host_recorder()) {
      CHECK(host_recorder().kept > kept + 10 * kSteps);
      CHECK(host_recorder().interrupted == interrupted);
    }
    CHECK(train(4) == expected);
  });
}

TEST_CASE("What is recorded begins when it is done, and a step that failed leaves nothing behind") {
  for_each_recorder([](auto&& record) {
    record(true);
    FloatArray values(5, 1.0f);
    values.device_for_reading();
    {
      const SilentStep silent(true);
      RecordedStep failing;
      values.fill(7);
    }
    CHECK(read(values) == std::vector<float>(5, 1.0f));
    const SilentStep silent(true);
    RecordedStep whole;
    values.fill(7);
    whole.end();
    CHECK(read(values) == std::vector<float>(5, 7.0f));
  });
}
