// SPDX-License-Identifier: MIT
#include "reports/show/tables/compare.h"

#include <catch2/catch.hpp>

#include "tests/support/table_parts.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

Record record_of(std::uint64_t seed, std::map<std::string, double> metrics) {
  return test::record_of({"room_1", "2dgs", seed}, std::move(metrics));
}

// One metric, a record a seed.
std::vector<Record> seeds_of(const std::string& metric, const std::vector<double>& values) {
  std::vector<Record> records;
  for (const double value : values) records.push_back(record_of(records.size(), {{metric, value}}));
  return records;
}

Record failed(std::uint64_t seed) {
  Record record = record_of(seed, {});
  record.failure = Failure{"train", "not-finite", "loss is not finite", {}};
  return record;
}

ValueChange only_change(const Comparison& comparison) {
  REQUIRE(comparison.values.size() == 1);
  return comparison.values[0];
}

}  // namespace

TEST_CASE("equal stores have no changes") {
  const auto records = seeds_of("psnr", {30, 31});
  const Comparison comparison = compare_records(records, records);
  CHECK(comparison.values.empty());
  CHECK(comparison.cells.empty());
  CHECK(comparison.num_cells == 2);
  CHECK(comparison.num_values == 1);
  CHECK(comparison.num_regressions() == 0);
}

TEST_CASE("a change within the larger spread over seeds is no regression, one beyond it is") {
  const auto before = seeds_of("psnr", {30.0, 30.4});
  const auto slight = only_change(compare_records(before, seeds_of("psnr", {29.8, 30.0})));
  CHECK(slight.verdict == Verdict::kWithinSpread);
  CHECK(slight.allowed == Approx(0.4));
  CHECK(slight.num_seeds == 2);
  CHECK_FALSE(slight.regression);
  const auto large = only_change(compare_records(before, seeds_of("psnr", {29.5, 29.7})));
  CHECK(large.verdict == Verdict::kWorse);
  CHECK(large.regression);
  CHECK(large.difference() == Approx(-0.6));
}

TEST_CASE("what is worse depends on the metric, of a region as of the whole image") {
  CHECK(metric_order("psnr@glass") == RankOrder::kHigherFirst);
  CHECK(metric_order("depth-absrel@glass") == RankOrder::kLowerFirst);
  CHECK(metric_order("mesh-f1@5cm") == RankOrder::kHigherFirst);
  CHECK(metric_order("mesh-cd") == RankOrder::kLowerFirst);
  CHECK(metric_order("of the future") == RankOrder::kNone);
  const auto lower = compare_records(seeds_of("normal-mae", {20}), seeds_of("normal-mae", {10}));
  CHECK(only_change(lower).verdict == Verdict::kBetter);
  const auto higher = compare_records(seeds_of("normal-mae", {10}), seeds_of("normal-mae", {20}));
  CHECK(only_change(higher).regression);
  const auto surfels = seeds_of("num-surfels", {1000}), more = seeds_of("num-surfels", {2000});
  CHECK(only_change(compare_records(surfels, more)).verdict == Verdict::kOther);
}

TEST_CASE("with one seed the tolerance decides, relative to the value before") {
  const auto before = seeds_of("psnr", {30}), after = seeds_of("psnr", {29.71});
  CHECK(only_change(compare_records(before, after)).verdict == Verdict::kWithinSpread);
  CompareOptions strict;
  strict.tolerance = 0.005;
  CHECK(only_change(compare_records(before, after, strict)).regression);
}

TEST_CASE("costs are listed, and regressions only on demand") {
  const auto before = seeds_of("fps", {100}), after = seeds_of("fps", {50});
  CHECK(only_change(compare_records(before, after)).verdict == Verdict::kWorse);
  CHECK(compare_records(before, after).num_regressions() == 0);
  CompareOptions options;
  options.costs = true;
  CHECK(compare_records(before, after, options).num_regressions() == 1);
}

TEST_CASE("a newly failed cell and a lost value are regressions, missing weights are not") {
  const std::vector<Record> before = {
      record_of(0, {{"psnr", 30}, {"lpips-vgg-3dgs", 0.1}, {"ssim-3dgs", 0.9}}),
      record_of(1, {{"psnr", 30}}),
      failed(2)};
  Record first = record_of(0, {{"psnr", 30}});
  first.not_measured["lpips-vgg-3dgs"] = "no weights";
  const Comparison comparison =
      compare_records(before, {first, failed(1), record_of(2, {{"psnr", 30}})});
  REQUIRE(comparison.cells.size() == 4);
  CHECK(comparison.cells[0].what == "lpips-vgg-3dgs has no value any more (no weights)");
  CHECK_FALSE(comparison.cells[0].regression);
  CHECK(comparison.cells[1].what == "ssim-3dgs has no value any more (no reason)");
  CHECK(comparison.cells[1].regression);
  CHECK(comparison.cells[2].what == "newly failed (train: loss is not finite)");
  CHECK(comparison.cells[2].regression);
  CHECK_FALSE(comparison.cells[3].regression);
  CHECK(comparison.num_regressions() == 2);
}

TEST_CASE("cells of one store only are listed and not compared") {
  const auto two = seeds_of("psnr", {30, 35}), one = seeds_of("psnr", {30});
  const Comparison fewer = compare_records(two, one);
  REQUIRE(fewer.before_only.size() == 1);
  CHECK(fewer.before_only[0].text() == "room_1/2dgs/1");
  CHECK(fewer.values.empty());  // the seed that both have is equal
  CHECK(compare_records(one, two).after_only.size() == 1);
}

TEST_CASE("regressions come first, the largest beyond its spread before others") {
  const std::map<std::string, double> before = {
      {"psnr", 30}, {"ssim-3dgs", 0.9}, {"normal-mae", 20}, {"depth-absrel", 0.1}};
  const std::map<std::string, double> after = {
      {"psnr", 29.9}, {"ssim-3dgs", 0.8}, {"normal-mae", 10}, {"depth-absrel", 0.2}};
  const Comparison comparison = compare_records({record_of(0, before)}, {record_of(0, after)});
  std::vector<std::string> order;
  for (const ValueChange& change : comparison.values) order.push_back(change.metric);
  CHECK(order == std::vector<std::string>{"depth-absrel", "ssim-3dgs", "normal-mae", "psnr"});
}

TEST_CASE("only the metrics of the tables are compared unless others are asked for") {
  const std::vector<Record> before = {record_of(0, {{"psnr", 30}, {"psnr-8bit", 30}})};
  const std::vector<Record> after = {record_of(0, {{"psnr", 30}, {"psnr-8bit", 20}})};
  CHECK(compare_records(before, after).num_values == 1);
  CompareOptions options;
  options.metrics = {"psnr*"};
  CHECK(compare_records(before, after, options).num_regressions() == 1);
}

TEST_CASE("other data, devices and resolutions are noted") {
  Record before = record_of(0, {{"psnr", 30}}), after = before;
  after.dataset_hash = "other";
  after.resolution = "160x90";
  after.environment["device"] = "gpu";
  CHECK(compare_records({before}, {after}).notes.size() == 3);
}

TEST_CASE("the Markdown table keeps a message with pipes and line ends in one line") {
  Record after = failed(0);
  after.failure->message = "a | b\n<c>";
  const std::string text =
      comparison_markdown(compare_records({record_of(0, {{"psnr", 30}})}, {after}));
  CHECK(
      text.find("- regression: room_1/2dgs/0: newly failed (train: a \\| b &lt;c>)\n") !=
      std::string::npos
  );
  CHECK(text.find("**1 regression; 1 cell and 0 values compared") == 0);
}

TEST_CASE("text, Markdown and JSON say the same of a change") {
  const Comparison comparison = compare_records(seeds_of("psnr", {30}), seeds_of("psnr", {25}));
  CHECK(comparison_text(comparison).find("psnr ↑      30     25          -5") != std::string::npos);
  CHECK(
      comparison_markdown(comparison)
          .find("| room_1/2dgs | psnr ↑ | 30 | 25 | -5 | ± 0.3 | regression |") != std::string::npos
  );
  const Json value = comparison_json(comparison)["values"][0];
  CHECK(value["difference"] == -5);
  CHECK(value["regression"] == true);
  CHECK(comparison_json(comparison)["regressions"] == 1);
}

TEST_CASE("a store is a folder or a file; neither may be empty") {
  const test::TempFolder folder;
  append_record(folder / "records.jsonl", record_of(0, {{"psnr", 30}}));
  CHECK(read_store(folder.path()).size() == 1);
  CHECK(read_store(folder / "records.jsonl").size() == 1);
  CHECK_THROWS_WITH(read_store(folder / "nowhere"), Catch::Contains("no such file"));
  write_file(folder / "empty.jsonl", "");
  CHECK_THROWS_WITH(read_store(folder / "empty.jsonl"), Catch::Contains("holds no record"));
}
