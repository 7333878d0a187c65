// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "glint/core/error.h"
#include "reports/show/viewer/look.h"

using namespace glint;
using Catch::Matchers::Contains;

namespace {

constexpr LookLimits kLimits{2, 4, 3};

Json good_look() {
  return {
      {"type", "look"},
      {"serial", 7},
      {"size", {320, 180}},
      {"camera",
       {{"world_from_cam", {{1, 0, 0, 0.5}, {0, 1, 0, 0}, {0, 0, 1, -2}, {0, 0, 0, 1}}},
        {"fov_x", 90}}},
      {"view", nullptr},
      {"panes", {{{"run", 0}, {"layer", "rgb"}}, {{"run", 1}, {"layer", "depth"}}}},
      {"scales", {{"reflection", 0}, {"transmission", 2}, {"transparency", 1}}},
      {"style", "discs"},
      {"hidden", {"interface"}},
      {"cut", {{"normal", {0, 0, 2}}, {"offset", 1.5}}}};
}

std::string refusal(const Json& change) {
  Json json = good_look();
  json.merge_patch(change);
  try {
    look_from_json(json, kLimits);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a look is what the page says") {
  const Look look = look_from_json(good_look(), kLimits);
  CHECK(look.serial == 7);
  CHECK(look.camera.size() == ImageSize{320, 180});
  CHECK(look.camera.fx == Approx(160));
  CHECK(look.camera.center().x == Approx(0.5));
  CHECK(look.camera.center().z == Approx(-2));
  REQUIRE(look.panes.size() == 2);
  CHECK(look.panes[1].layer == "depth");
  CHECK(look.scales == LightScales{0, 2, 1});
  CHECK(look.style == SurfelStyle::kDiscs);
  CHECK(look.hidden == std::vector<std::string>{"interface"});
  REQUIRE(look.cut.has_value());
  CHECK(look.cut->normal.z == Approx(1));
  CHECK_FALSE(look.view.has_value());
}

TEST_CASE("what a look lacks is as usual") {
  Json json = good_look();
  for (const char* field : {"scales", "style", "hidden", "cut"}) json.erase(field);
  const Look look = look_from_json(json, kLimits);
  CHECK(look.scales == LightScales{});
  CHECK(look.style == SurfelStyle::kImage);
  CHECK_FALSE(look.cut.has_value());
}

TEST_CASE("a look out of bounds is refused by its field") {
  CHECK_THAT(refusal({{"serial", -1}}), Contains("serial: -1"));
  CHECK_THAT(refusal({{"size", {320}}}), Contains("size: expected a list of 2"));
  CHECK_THAT(refusal({{"size", {320, 1e9}}}), Contains("size: 1000000000.0"));
  CHECK_THAT(refusal({{"camera", {{"fov_x", 0}}}}), Contains("fov_x: 0"));
  CHECK_THAT(refusal({{"camera", {{"world_from_cam", {1, 2}}}}}), Contains("4 x 4"));
  CHECK_THAT(
      refusal({{"camera", {{"world_from_cam", {{2, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}}}}),
      Contains("no rigid pose")
  );
  CHECK_THAT(refusal({{"panes", Json::array()}}), Contains("panes"));
  CHECK_THAT(refusal({{"panes", {{{"run", 2}, {"layer", "rgb"}}}}}), Contains("run: 2"));
  CHECK_THAT(refusal({{"panes", {{{"run", 0.5}, {"layer", "rgb"}}}}}), Contains("no index"));
  CHECK_THAT(refusal({{"panes", {{{"run", 0}}}}}), Contains("layer"));
  CHECK_THAT(refusal({{"scales", {{"reflection", 5}}}}), Contains("reflection: 5"));
  CHECK_THAT(refusal({{"style", "dots"}}), Contains("style: \"dots\""));
  CHECK_THAT(refusal({{"hidden", {3}}}), Contains("hidden: 3"));
  CHECK_THAT(refusal({{"cut", {{"normal", {0, 0, 0}}}}}), Contains("no direction"));
  CHECK_THAT(refusal({{"view", {{"split", "val"}, {"index", 0}}}}), Contains("split"));
  CHECK_THAT(refusal({{"view", {{"split", "test"}, {"index", 3}}}}), Contains("index: 3"));
}

TEST_CASE("a message that is no object is refused") {
  CHECK_THROWS_AS(look_from_json(Json::array(), kLimits), Error);
  CHECK_THROWS_AS(look_from_json(Json(3), kLimits), Error);
  CHECK_THROWS_AS(look_from_json({{"serial", 1}, {"camera", 3}}, kLimits), Error);
}
