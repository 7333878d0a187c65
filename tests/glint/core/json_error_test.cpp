// SPDX-License-Identifier: MIT
#include "glint/core/json_error.h"

#include <catch2/catch.hpp>

using namespace glint;
using Json = nlohmann::json;

namespace {

template <class F>
std::string error_of(F&& f) {
  try {
    const auto value = f();
    return Json(value).dump();
  } catch (const Json::exception& error) {
    return json_error(error);
  }
}

}  // namespace

TEST_CASE("errors of JSON say where and what, and nothing of the library") {
  CHECK(error_of([] {
          return Json::parse("{\n \"a\": [1, 2,, 3]}");
        }) == "line 2, column 13: unexpected ','; expected '[', '{', or a literal");
  CHECK(error_of([] {
          return Json::parse("{\"a\": ");
        }) == "line 1, column 7: unexpected end of input; expected '[', '{', or a literal");
  CHECK(error_of([] {
          return Json::parse("{\"a\": nul}");
        }).rfind("line 1, column 10: invalid literal", 0) == 0);
  CHECK(error_of([] { return Json(Json::object().at("fx")); }) == "key 'fx' not found");
  CHECK(error_of([] { return Json("a").get<double>(); }) == "type must be number, but is string");
}
