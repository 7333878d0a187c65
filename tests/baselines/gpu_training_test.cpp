// SPDX-License-Identifier: MIT
// Whole trainings on GPU backends end where they end on the CPU.
#include <catch2/catch.hpp>

#include "glint/method.h"
#include "metrics/psnr.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

// Rounding grows: trainings whose colours learn by 1e-5, 2e-5, 3e-5 faster end within 0.002
// (2dgs), 0.006 (glint), 0.05 dB (glint/plus) of each other after 100 steps; after 150 glint/text
// already ends within 0.24 dB.
constexpr int kSteps = 100;
constexpr double kSameQuality = 0.1;  // dB

// A training on the device in use, with a copy of the scene there.
struct Training {
  Scene scene = small_room();
  std::unique_ptr<Method> method;
  std::vector<StepStats> steps;

  Training(const std::string& id, int planned, int run) : method(create_method(id)) {
    method->initialize(scene, {planned, 0});
    for (int i = 0; i < run; ++i) steps.push_back(method->step(i));
  }
  double test_psnr() const {
    double sum = 0;
    for (const View& view : scene.test) sum += psnr(method->render(view.camera)["rgb"], view.rgb);
    return sum / static_cast<double>(scene.test.size());
  }
};

}  // namespace

// Later, rounding grows into other surfels: trainings are chaotic.
TEST_CASE("Every method's first steps have the same losses on a GPU") {
  constexpr int kFirstSteps = 6;
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    // So short that all sets and losses are there from the start.
    const Training cpu(id, kFirstSteps, kFirstSteps);
    for_each_gpu_backend([&, &id = id](const std::string& backend) {
      INFO(id << " with " << backend);
      const Training gpu(id, kFirstSteps, kFirstSteps);
      for (int i = 0; i < kFirstSteps; ++i)
        for (const auto& [name, value] : cpu.steps[i].terms) {
          INFO("step " << i << ", " << name);
          CHECK(gpu.steps[i].terms.at(name) == Approx(value).epsilon(0.01));
        }
    });
  }
}

TEST_CASE("Methods train to the same quality on a GPU") {
  watch_memory(false);
  for (const char* id : {"2dgs", "glint", "glint/plus"}) {
    const double expected = Training(id, kSteps, kSteps).test_psnr();
    for_each_gpu_backend([&](const std::string& backend) {
      INFO(id << " with " << backend);
      CHECK(Training(id, kSteps, kSteps).test_psnr() == Approx(expected).margin(kSameQuality));
    });
  }
}
