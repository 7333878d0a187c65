// SPDX-License-Identifier: MIT
#include "reports/show/tables/results_page.h"

#include <catch2/catch.hpp>

#include "tests/support/table_parts.h"

using namespace glint;
using namespace glint::test;

TEST_CASE("docs/results/RESULTS.md and the README's table are what the committed records give") {
  const ResultsInfo info = read_results_info(results_parts(".").front());
  const auto records = read_records(info.records);
  REQUIRE(!records.empty());
  INFO("run `glint-bench results` and commit what it writes");
  CHECK(read_file("docs/results/RESULTS.md") == results_markdown("."));
  const std::string readme = read_file("README.md");
  CHECK(readme == with_results(readme, readme_results(info, records)));
}

TEST_CASE("Results stand between the README's markers, and nothing else changes") {
  const std::string readme =
      std::string("before\n") + kResultsBegin + "\nold\n" + kResultsEnd + "\nafter\n";
  const std::string written = with_results(readme, "new\n");
  CHECK(written == std::string("before\n") + kResultsBegin + "\nnew\n" + kResultsEnd + "\nafter\n");
  CHECK(with_results(written, "new\n") == written);
  CHECK_THROWS_AS(with_results("no markers", "new\n"), Error);
}

TEST_CASE("The page says which revision trained and which scored") {
  Record record = record_of("glint", 30);
  record.warnings = {"trained by revision abc1234"};
  record.environment = {{"git_revision", "def5678"}, {"date", "2026-01-01T00:00:00Z"}};
  const std::string page = results_part({"r.jsonl", "glint-bench all", "a remark"}, {record});
  for (const char* text :
       {"abc1234", "def5678", "2026-01-01", "glint-bench all", "a remark", "30.00"})
    CHECK_THAT(page, Catch::Contains(text));
  CHECK_THAT(page, !Catch::Contains("cells shared"));
}

TEST_CASE("The page says that cells shared a card") {
  Record record = record_of("glint", 30);
  record.environment = {{"device", "a card"}, {"cells_on_card", 6}};
  CHECK_THAT(
      results_part({"r.jsonl", "glint-bench all", ""}, {record}),
      Catch::Contains("device a card, which up to 6 cells shared: times are too long\n")
  );
}

TEST_CASE("A part of the page may have a title and some tables alone") {
  const Record record = record_of("glint", 30);
  const ResultsInfo info{"r.jsonl", "glint-bench all", "", "Captures", {"summary"}};
  const std::string part = results_part(info, {record});
  CHECK(part.starts_with("# Captures\n\n- Command"));
  CHECK_THAT(part, Catch::Contains("## Summary"));
  CHECK_THAT(part, !Catch::Contains("## Photometric evaluation"));
  CHECK_THAT(part, Catch::Contains("Mean over test views"));
  Record second = record;
  second.cell.seed = 1;
  second.metrics = {{"psnr", 40.0}};
  ResultsInfo first = info;
  first.cells = {"room_*/glint/0"};
  CHECK(results_part(first, {record, second}) == part);
  CHECK(readme_results(first, {record, second}) == readme_results(info, {record}));
  CHECK(results_part(info, {record, second}) != part);
  CHECK_THAT(part, Catch::Contains("| PSNR (dB)"));
  ResultsInfo without = info;
  without.without = {"psnr"};
  CHECK_THAT(results_part(without, {record}), !Catch::Contains("| PSNR (dB)"));
  ResultsInfo other = info;
  other.other_data = true;
  CHECK_THAT(results_part(other, {record}), !Catch::Contains("Mean over test views"));
  CHECK_THAT(part, Catch::Contains("| EnvGS | missing"));
  ResultsInfo study = info;
  study.measured_alone = true;
  CHECK_THAT(results_part(study, {record}), !Catch::Contains("EnvGS"));
  CHECK_THAT(results_part(study, {record}), Catch::Contains("| GLINT | "));
}
