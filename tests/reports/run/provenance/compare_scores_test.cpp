// SPDX-License-Identifier: MIT
// Which values have to be the same, and what is said of the others.
#include "reports/run/provenance/compare_scores.h"

#include <catch2/catch.hpp>

#include <limits>

#include "metrics/metric.h"

using namespace glint;

namespace {

// As this program writes metrics.json. Not before main(): metrics register themselves.
Json file_of(const Json& means, const Json& views = Json::array()) {
  return {{"metrics", means}, {"views", views}, {"protocol", metric_protocols()}};
}

ScoreComparison compare_means(const Json& then, const Json& now) {
  return compare_scores(file_of(then), file_of(now));
}

}  // namespace

TEST_CASE("values are the same to the last digit, differ by rounding, or differ") {
  CHECK(compare_means({{"psnr", 24.5}}, {{"psnr", 24.5}}).equal == 1);
  const auto near = compare_means({{"psnr@glass", 24.5}}, {{"psnr@glass", 24.5 * (1 + 1e-9)}});
  CHECK(near.equal == 0);
  CHECK(near.differing.empty());
  REQUIRE(near.rounded.size() == 1);
  CHECK(near.rounded[0].starts_with("psnr@glass "));
  CHECK(
      compare_means({{"psnr", 24.5}}, {{"psnr", 24.501}}).differing ==
      std::vector<std::string>{"psnr 24.5, now 24.501"}
  );
}

TEST_CASE("costs and metrics of others are not computed again; what should be there differs") {
  const auto found =
      compare_means({{"fps", 20.0}, {"nosuch", 1.0}, {"psnr", 24.5}}, Json::object());
  CHECK(found.not_recomputed == std::vector<std::string>{"fps", "nosuch"});
  CHECK(found.differing == std::vector<std::string>{"psnr cannot be computed any more"});
}

TEST_CASE("a metric that came later is told; one that was known and had no value differs") {
  CHECK(compare_scores(Json::object(), file_of({{"psnr", 1.0}})).added.size() == 1);
  CHECK(compare_means(Json::object(), {{"psnr", 1.0}}).differing.size() == 1);
}

TEST_CASE("what was not finite and still is not is equal") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(compare_means({{"psnr", nullptr}}, {{"psnr", infinity}}).equal == 1);
  CHECK(compare_means({{"psnr", nullptr}}, {{"psnr", 20.0}}).differing.size() == 1);
}

TEST_CASE("views go by their names") {
  const auto file = [](const char* view, double psnr) {
    return file_of(
        {{"psnr", 20.0}},
        Json::array({{{"name", view}, {"metrics", {{"psnr", psnr}, {"fps", 1.0}}}}})
    );
  };
  const Json then = file("a", 20);
  CHECK(compare_scores(then, file("a", 20)).equal == 3);
  CHECK(
      compare_scores(then, file("a", 21)).differing ==
      std::vector<std::string>{"a: psnr 20.0, now 21.0"}
  );
  const auto other = compare_scores(then, file("b", 20)).differing;
  REQUIRE(other.size() == 2);
  CHECK(other[0] == "a: psnr cannot be computed any more");
  CHECK(other[1] == "b: psnr was not there, now 20.0");
}
