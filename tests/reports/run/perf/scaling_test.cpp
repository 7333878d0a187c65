// SPDX-License-Identifier: MIT
#include "reports/run/perf/scaling.h"

#include <catch2/catch.hpp>

#include <cmath>

#include "glint/core/progress.h"
#include "glint/method.h"
#include "glint/scene/image_files.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

ScalingOptions small_options(const std::string& methods) {
  set_quiet(true);
  ScalingOptions options;
  options.base.width = 32;
  options.base.height = 18;
  options.base.surfels = 100;
  options.base.runs = 1;
  options.base.only = methods;
  options.surfels = {60, 240};
  options.sizes = {{16, 9}, {32, 18}};
  return options;
}

// Points at 1, 2, 4 and 8 thousand surfels, whose time and pairs go with these powers of them.
ScalingSweep sweep_with(double time_power, double pairs_power) {
  ScalingSweep sweep{"m", ScalingVariable::kSurfels, {}, {}};
  for (const std::size_t surfels : {1000, 2000, 4000, 8000}) {
    const auto n = static_cast<double>(surfels);
    sweep.points.push_back({surfels, {10, 10}, std::pow(n, pairs_power), std::pow(n, time_power), n}
    );
  }
  return sweep;
}

}  // namespace

TEST_CASE("the slope of logarithms is the exponent, through all points and the last three") {
  const LogSlope square = log_slope({1, 2, 4}, {3, 12, 48});
  CHECK(square.fitted == Approx(2));
  CHECK(square.last == Approx(2));
  const LogSlope bent = log_slope({0.1, 1, 10, 100}, {5, 5, 50, 500});  // constant, then linear
  CHECK(bent.fitted == Approx(0.7));
  CHECK(bent.last == Approx(1));
  CHECK(log_slope({1, 10}, {2, 20}).last == Approx(1));
  CHECK(std::isnan(log_slope({1}, {2}).fitted));
  CHECK(std::isnan(log_slope({}, {}).last));
}

TEST_CASE("steeper than linear, in the variable and in pairs, is a defect") {
  CHECK_FALSE(sweep_with(1, 0).is_steep());
  CHECK_FALSE(sweep_with(1.05, 0).is_steep());
  CHECK(sweep_with(1.3, 0).is_steep());
  CHECK(sweep_with(1.3, 1).is_steep());
  CHECK_FALSE(sweep_with(1.3, 1.3).is_steep());
  const ScalingOptions options = small_options("*");
  CHECK_THAT(
      scaling_to_text(options, {sweep_with(2, 1)}),
      Catch::Contains("2.00 2.00") && Catch::Contains("STEEPER THAN LINEAR")
  );
  CHECK(scaling_to_json(options, {sweep_with(2, 1)})["rows"][0]["steep"] == true);
}

TEST_CASE("every method is timed against surfels and pixels") {
  ScalingOptions options = small_options("*");
  options.surfels = {60};
  options.sizes = {{16, 9}};
  const std::vector<ScalingSweep> sweeps = run_scaling(options);
  std::size_t methods = 0;
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) methods += spec.overrides.empty();
  CHECK(sweeps.size() == 2 * methods);
  for (const ScalingSweep& sweep : sweeps) {
    INFO(sweep.method);
    REQUIRE(sweep.points.size() == 1);
    CHECK(sweep.points[0].ms > 0);
    CHECK(std::isnan(sweep.slope_of(&ScalingPoint::ms).fitted));
    CHECK_FALSE(sweep.is_steep());
  }
}

TEST_CASE("a sweep has its variable's points, the other variable as given, and pairs of each") {
  const std::vector<ScalingSweep> sweeps = run_scaling(small_options("2dgs"));
  REQUIRE(sweeps.size() == 2);
  CHECK(sweeps[0].variables() == std::vector<double>{60, 240});
  CHECK(sweeps[1].variables() == std::vector<double>{144, 576});
  for (const ScalingPoint& point : sweeps[0].points) CHECK(point.size == ImageSize{32, 18});
  for (const ScalingPoint& point : sweeps[1].points) CHECK(point.surfels == 100);
  CHECK(sweeps[1].points[1].pairs > 2 * sweeps[1].points[0].pairs);
  const Json json = scaling_to_json(small_options("2dgs"), sweeps);
  CHECK(json["rows"].size() == 2);
  CHECK(json["rows"][1]["points"][1]["width"] == 32);
  CHECK(json["rows"][0]["time_slope"]["fitted"].is_number());
}

TEST_CASE("a point that memory has no room for is left out and named, not tried") {
  ScalingOptions options = small_options("2dgs");
  options.surfels = {20000, 2000000000000};
  options.sizes = {};
  const std::vector<ScalingSweep> sweeps = run_scaling(options);
  CHECK(sweeps[0].points.size() == 1);
  CHECK(sweeps[0].points[0].memory_mb > 20000 * 58 * 4 * 4 / 1e6);  // parameters, as Adam has them
  REQUIRE(sweeps[0].left_out.size() == 1);
  CHECK_THAT(sweeps[0].left_out[0], Catch::Contains("2000000000000 surfels"));
  CHECK_THAT(scaling_to_text(options, sweeps), Catch::Contains("left out: 2000000000000 surfels"));
}

TEST_CASE("how steps grow is drawn") {
  const test::TempFolder folder;
  draw_scaling(folder / "scaling.png", {sweep_with(1, 0), sweep_with(0.5, 0)});
  const Image picture = read_image(folder / "scaling.png");
  CHECK(picture.width() > 1000);
  CHECK(fs::exists(folder / "scaling.pdf"));
}
