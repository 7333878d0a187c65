// SPDX-License-Identifier: MIT
// Which values have to be the same to the last digit, and what is said of the others.
#include <catch2/catch.hpp>

#include <limits>

#include "metrics/metric.h"
#include "reports/provenance/compare_scores.h"

using namespace glint;

namespace {

constexpr double kTiny = 1e-9;  // relative

// Not before main(): metrics register themselves.
ScoreRules on_cpu() { return {true, metric_protocols()}; }
ScoreRules on_a_gpu() { return {false, metric_protocols()}; }

std::string network_metric() {
  for (const MetricFamily& family : metric_families())
    if (family.files) return family.metrics.front().id;
  return "";
}

}  // namespace

TEST_CASE("values of the CPU are the same to the last digit or differ") {
  const ScoreComparison same = compare_values({{"psnr", 24.5}}, {{"psnr", 24.5}}, on_cpu());
  CHECK(same.equal == 1);
  CHECK(same.differing.empty());
  const double near = 24.5 * (1 + kTiny);
  const ScoreComparison other =
      compare_values({{"psnr@glass", 24.5}}, {{"psnr@glass", near}}, on_cpu());
  CHECK(other.equal == 0);
  REQUIRE(other.differing.size() == 1);
  CHECK(other.differing[0].starts_with("psnr@glass 24.5, now 24.5000"));
}

TEST_CASE("values of a GPU and of networks may differ by rounding, and no more") {
  CHECK(compare_values({{"psnr", 1.0}}, {{"psnr", 1 + kTiny}}, on_a_gpu()).rounded.size() == 1);
  CHECK(compare_values({{"psnr", 1.0}}, {{"psnr", 1.001}}, on_a_gpu()).differing.size() == 1);
  const std::string id = network_metric();
  REQUIRE_FALSE(id.empty());
  CHECK(compare_values({{id, 1.0}}, {{id, 1 + kTiny}}, on_cpu()).rounded.size() == 1);
  CHECK(compare_values({{id, 1.0}}, {{id, 1.001}}, on_cpu()).differing.size() == 1);
}

TEST_CASE("costs and metrics of others are not computed again; what should be there differs") {
  const ScoreComparison found =
      compare_values({{"fps", 20.0}, {"nosuch", 1.0}, {"psnr", 24.5}}, {}, on_cpu());
  CHECK(found.not_recomputed == std::vector<std::string>{"fps", "nosuch"});
  CHECK(found.differing == std::vector<std::string>{"psnr cannot be computed any more"});
}

TEST_CASE("a metric that came later is told; one that was known and had no value differs") {
  CHECK(compare_values({}, {{"psnr", 1.0}}, ScoreRules{}).added.size() == 1);
  CHECK(compare_values({}, {{"psnr", 1.0}}, on_cpu()).differing.size() == 1);
}

TEST_CASE("what was not finite and still is not is equal") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(compare_values({{"psnr", nullptr}}, {{"psnr", infinity}}, on_cpu()).equal == 1);
  CHECK(compare_values({{"psnr", nullptr}}, {{"psnr", 20.0}}, on_cpu()).differing.size() == 1);
}

TEST_CASE("views go by their names") {
  const Json file = {
      {"metrics", {{"psnr", 20.0}}}, {"views", {{{"name", "a"}, {"metrics", {{"psnr", 20.0}}}}}}};
  View view;
  view.name = "a";
  RunScores now;
  now.views = {{{"psnr", 20.0}}};
  now.means = {{"psnr", 20.0}};
  CHECK(compare_scores(file, now, {view}, on_cpu()).equal == 2);
  now.views[0]["psnr"] = 21;
  const auto differing = compare_scores(file, now, {view}, on_cpu()).differing;
  CHECK(differing == std::vector<std::string>{"a: psnr 20.0, now 21.0"});
  view.name = "b";
  CHECK(compare_scores(file, now, {view}, on_cpu()).differing[0] == "b has no values");
}
