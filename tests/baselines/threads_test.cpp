// SPDX-License-Identifier: MIT
// Whole steps of every method on several threads: small enough for ThreadSanitizer.
#include <catch2/catch.hpp>

#include "glint/core/parallel.h"
#include "glint/core/rng.h"
#include "glint/method.h"
#include "tests/support/box_room.h"

using namespace glint;
using namespace glint::test;

namespace {

Scene room() {
  Scene scene;
  scene.name = "box";
  scene.train = box_room_views(3, {48, 36});
  Rng rng(1, 1);
  for (int i = 0; i < 400; ++i) {
    scene.points.positions.push_back({rng.uniform(0, 4), rng.uniform(0, 3), rng.uniform(0, 2.5f)});
    scene.points.colors.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
  }
  set_extent(scene);
  return scene;
}

std::vector<double> losses(const std::string& id, const Scene& scene, int threads) {
  set_num_threads(threads);
  const auto method = create_method(id);
  method->initialize(scene, {.iterations = 30});
  std::vector<double> losses;
  for (int i = 0; i < 30; i += 5) losses.push_back(method->step(i).loss);
  set_num_threads(0);
  return losses;
}

}  // namespace

TEST_CASE("a step is the same on four threads as on one, whatever the method") {
  const Scene scene = room();
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    if (id.find('/') != std::string::npos) continue;  // variants run the same code
    INFO(id);
    CHECK(losses(id, scene, 4) == losses(id, scene, 1));
  }
}
