// SPDX-License-Identifier: MIT
// Settings that no training can use are errors when a method is made, before any data are read.
#include "glint/setting_ranges.h"

#include <catch2/catch.hpp>

#include <cmath>

#include "glint/method.h"

using namespace glint;
using Catch::Contains;

namespace {

std::string error_of(const std::string& method, const Json& settings) {
  try {
    create_method(method, settings);
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kUsage);
    return error.what();
  }
  return "none";
}

// Just outside of the range, on either side where there is one. Whole numbers fit all settings.
std::vector<double> outside(const ValueRange& range) {
  std::vector<double> values;
  if (std::isfinite(range.least)) values.push_back(range.least - (range.without_least ? 0 : 1));
  if (std::isfinite(range.most)) values.push_back(range.most + (range.without_most ? 0 : 1));
  return values;
}

}  // namespace

TEST_CASE("Values that a setting cannot have are named, with what is allowed") {
  struct Case {
    const char* method;
    Json settings;
    const char* message;
  };
  const Case cases[] = {
      {"envgs", {{"mirror_near", -2}}, "envgs: mirror_near is -2, expected at least 0"},
      {"glint", {{"reflection_cells", 0}}, "reflection_cells is 0, expected at least 1"},
      {"envgs/simple", {{"reflection_cells", -1}}, "envgs/simple: reflection_cells is -1"},
      {"2dgs", {{"random_points", -1}}, "random_points is -1, expected at least 4"},
      {"glint", {{"initial_transparency", 0}}, "is 0, expected above 0 and below 1"},
      {"glint/plus", {{"initial_transparency", 1.0}}, "is 1, expected above 0 and below 1"},
      {"envgs", {{"initial_specular", 1.5}}, "initial_specular is 1.5, expected above 0"},
      {"pgsr", {{"initial_opacity", 0.0}}, "initial_opacity is 0, expected above 0 and below 1"},
      {"pgsr", {{"trim_interval", 0}}, "trim_interval is 0, expected at least 1"},
      {"ref-gs", {{"initial_albedo", 0.0}}, "expected above 0 and at most 1"},
      {"tsgs", {{"min_opacity", 1}}, "min_opacity is 1, expected at least 0 and below 1"},
      {"2dgs",
       {{"rate_position_final", 0.0}},
       "rate_position_final is 0, expected above 0, or rate_position=0"},
      {"tsgs", {{"rate_lobe_final", 0.0}}, "expected above 0, or rate_lobe=0"},
      {"glint", {{"guidance", "both"}}, "guidance is 'both', expected paper or release"},
  };
  for (const Case& c : cases) CHECK_THAT(error_of(c.method, c.settings), Contains(c.message));
}

TEST_CASE("A last rate may be anything where the first is zero") {
  CHECK_NOTHROW(create_method("2dgs", {{"rate_position", 0}, {"rate_position_final", 0}}));
  CHECK_NOTHROW(create_method("tsgs", {{"rate_lobe", 0}, {"rate_lobe_final", 0}}));
}

TEST_CASE("Every method that has a setting refuses what is outside of its range") {
  for (const SettingRange& setting : setting_ranges()) {
    int methods = 0;
    for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
      if (!create_method(id)->config().contains(setting.name)) continue;
      ++methods;
      for (const double value : outside(setting.range))
        CHECK_THAT(
            error_of(id, {{setting.name, value}}), Contains(fmt::format("{} is ", setting.name))
        );
    }
    INFO(setting.name);
    CHECK(methods > 0);
    CHECK(!outside(setting.range).empty());
  }
}
