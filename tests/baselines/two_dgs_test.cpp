// SPDX-License-Identifier: MIT
// What is particular to 2DGS: its setting for bounded scenes.
#include <catch2/catch.hpp>

#include "glint/method.h"
#include "glint/render/surfel_set.h"
#include "glint/scene/ply.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

std::unique_ptr<Method> trained(const char* id, int iterations) {
  auto method = create_method(id);
  method->initialize(small_room(), {iterations, 0});
  for (int i = 0; i < iterations; ++i) {
    const StepStats stats = method->step(i);
    const bool late = i >= iterations / 10;  // 3000 of 30,000
    CHECK((stats.terms.count("distortion") == 1) == (late && std::string(id) == "2dgs/bounded"));
  }
  return method;
}

SurfelSet surfels_of(const Method& method) {
  const TempFolder folder;
  method.save(folder.path().string());
  return SurfelSet(read_surfel_ply(folder.path() / "interface.ply"));
}

}  // namespace

TEST_CASE("2DGS for bounded scenes renders the median depth, 2DGS the expected one") {
  const Camera& camera = small_room().test.front().camera;
  for (const char* id : {"2dgs", "2dgs/bounded"}) {
    const auto method = trained(id, 40);
    SurfelSet set = surfels_of(*method);
    const RasterOutput& out = set.forward(camera, 0);
    const Image depth = method->render(camera)["depth"];
    const bool median = std::string(id) == "2dgs/bounded";
    CHECK(
        std::equal(
            depth.values().begin(), depth.values().end(), out.depth_median.values().begin()
        ) == median
    );
  }
}

TEST_CASE("2DGS refuses a depth that it does not know") {
  CHECK_THROWS_WITH(create_method("2dgs", {{"depth", "sideways"}}), Catch::Contains("sideways"));
}

TEST_CASE("2DGS says in which step it reset opacities") {
  auto method = create_method("2dgs");
  method->initialize(small_room(), {1000, 0});  // 300 steps between resets, the fewest
  for (int i = 0; i < 310; ++i) {
    const StepStats stats = method->step(i);
    CHECK(
        stats.events ==
        (i == 299 ? std::vector<std::string>{"opacities reset"} : std::vector<std::string>{})
    );
  }
}
