// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "datasets/dataset.h"
#include "datasets/exchange/exchange_scene.h"
#include "glint/core/progress.h"
#include "tests/datasets/front3d/houses.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

TEST_CASE("a room for other renderers has the cameras and the exposure of the made one") {
  set_quiet(true);
  const Front3dOptions options{
      .house = kFlatHouse.string(), .width = 32, .height = 18, .views = 9, .spp = 2};
  const TempFolder temporary;
  REQUIRE(make_front3d(options, temporary / "made", false));
  const Json made = Json::parse(read_file(temporary / "made/scene.json"));
  const ExchangeScene exchange = front3d_for_exchange(options);
  CHECK(exchange.name == made["name"]);
  CHECK(exchange.origin["hash"] == made["hash"]);
  CHECK(exchange.exposure == made["exposure"].get<float>());
  REQUIRE(exchange.views.size() == 9);
  const Scene scene = load_scene(temporary / "made", {});
  CHECK(exchange.views[8].name == scene.test[1].name);
  CHECK(exchange.views[8].is_test);
  CHECK(length(exchange.views[8].camera.center() - scene.test[1].camera.center()) < 1e-9);
  write_exchange_scene(exchange, temporary / "exchange");
  CHECK(fs::exists(temporary / "exchange/meshes.obj"));
}
