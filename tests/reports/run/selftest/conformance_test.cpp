// SPDX-License-Identifier: MIT
#include "reports/run/selftest/conformance.h"

#include <catch2/catch.hpp>
#include <set>

#include "glint/core/progress.h"
#include "metrics/metric.h"
#include "reports/run/selftest/programs.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

const bool quiet = (set_quiet(true), true);

const fs::path kVectors = "metrics/conformance";

}  // namespace

TEST_CASE("Every conformance vector passes") {
  const auto results = run_vectors(read_vectors(kVectors), kVectors);
  CHECK(results.size() > 80);
  for (const VectorResult& result : results) {
    INFO(result.vector.id << ": " << result.note);
    if (result.status == VectorStatus::kSkipped) {
      WARN("skipped: " << result.vector.id << ": " << result.note);
      continue;
    }
    CHECK(
        result.found == Approx(result.vector.expected).margin(result.vector.tolerance).epsilon(0)
    );
    CHECK(result.status == VectorStatus::kPassed);
  }
}

TEST_CASE("Every metric that views are scored with has a vector") {
  std::set<std::string> covered;
  for (const ConformanceVector& vector : read_vectors(kVectors)) covered.insert(vector.value);
  for (const MetricFamily& family : metric_families())
    for (const Metric& metric : family.metrics) {
      // One network stands for all: the others differ in their layers alone, and the weights of
      // VGG16 are nowhere to make a value with.
      if (metric.id.starts_with("lpips-")) continue;
      INFO(metric.id);
      CHECK(covered.contains(metric.id));
    }
  for (const char* id : {"lpips-alex", "mesh-cd", "mesh-f1@5cm", "mesh-normal", "mesh-cd-p2p"})
    CHECK(covered.contains(id));
}

TEST_CASE("The program carries the files that the folder has") {
  const test::TempFolder folder;
  export_conformance(folder.path());
  std::size_t count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kVectors)) {
    if (!entry.is_regular_file()) continue;
    ++count;
    const fs::path path = fs::relative(entry.path(), kVectors);
    INFO(path);
    CHECK(read_file(folder.path() / path) == read_file(entry.path()));
  }
  CHECK(count == conformance_files().size());
}

TEST_CASE("Values of another implementation are judged by the same tolerances") {
  const std::vector<ConformanceVector> vectors = {
      {"a", {"x"}, "psnr", 20, 0.01, "", ""},
      {"b", {"x"}, "psnr", 20, 0.01, "", ""},
      {"c", {"x"}, "psnr", 20, 0.01, "", ""}};
  const auto results = check_values(vectors, {{"a", 20.009}, {"b", 20.02}});
  CHECK(results[0].status == VectorStatus::kPassed);
  CHECK(results[1].status == VectorStatus::kFailed);
  CHECK(results[2].status == VectorStatus::kSkipped);
}

TEST_CASE("A vector whose program fails or prints no such value has failed") {
  const std::vector<ConformanceVector> vectors = {
      {"missing-file", {"glint-psnr", "no.png", "no.png"}, "psnr", 1, 1, "", ""},
      {"no-program", {"glint-nothing"}, "psnr", 1, 1, "", ""},
      {"no-value",
       {"glint-psnr", "image/reference.png", "image/reference.png"},
       "ssim",
       1,
       1,
       "",
       ""}};
  for (const VectorResult& result : run_vectors(vectors, kVectors)) {
    INFO(result.vector.id);
    CHECK(result.status == VectorStatus::kFailed);
    CHECK(!result.note.empty());
  }
}

TEST_CASE("Damaged lists of vectors are refused") {
  const test::TempFolder folder;
  CHECK_THROWS_AS(read_vectors(folder.path()), Error);
  write_file(folder.path() / "vectors.json", "{}");
  CHECK_THROWS_WITH(read_vectors(folder.path()), Catch::Contains("no list 'vectors'"));
  write_file(folder.path() / "vectors.json", R"({"vectors": [{"id": "x"}]})");
  CHECK_THROWS_WITH(read_vectors(folder.path()), Catch::Contains("'x'"));
}
