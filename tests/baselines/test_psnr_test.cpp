// SPDX-License-Identifier: MIT
// Looks at test views leave no trace in what is trained: buffers, phases and random numbers.
#include "glint/train/test_psnr.h"

#include <catch2/catch.hpp>

#include "glint/method.h"
#include "tests/support/all_trained.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kSteps = 24;  // all phases of a run, scaled to it

// `every`: of TestPsnr.
std::string trained_bytes(const std::string& id, const Scene& scene, int every) {
  const auto method = create_method(id);
  const TestPsnr test_psnr(scene, every);
  method->initialize(scene, {kSteps, 3});
  for (int i = 0; i < kSteps; ++i) {
    method->step(i);
    if (test_psnr.is_due(i, kSteps)) CHECK(test_psnr.measure(*method) > 3);
  }
  return saved_bytes(*method);
}

}  // namespace

TEST_CASE("A training that looks at test views ends with the same bytes, whatever the method") {
  Scene scene = small_room();
  scene.train.resize(5);
  scene.test.resize(2);
  for (const std::string& id : all_trained()) {
    INFO(id);
    CHECK((trained_bytes(id, scene, 0) == trained_bytes(id, scene, 3)));
  }
}
