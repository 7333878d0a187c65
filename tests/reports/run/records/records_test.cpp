// SPDX-License-Identifier: MIT
#include "reports/run/records/records.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <ctime>
#include <limits>

#include "reports/run/records/embedded.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

Record sample_record() {
  Record record;
  record.profile = "ci";
  record.dataset = "glassroom";
  record.cell = {"room_1", "glint/no-trans", 3};
  record.metrics = {{"psnr", 31.23456789012345}, {"psnr@glass", 27.5}};
  record.train_key = "c0ffee";
  record.score_key = "beef";
  record.training_views = 42;
  record.num_surfels = 20000;
  record.not_applicable = {"transparency-iou"};
  record.timings["train"] = 12.5;
  return record;
}

}  // namespace

TEST_CASE("a record reads back as it was written, to the last bit of its numbers") {
  const test::TempFolder folder;
  append_record(folder.path() / "records.jsonl", sample_record());
  const auto records = read_records(folder.path() / "records.jsonl");
  REQUIRE(records.size() == 1);
  CHECK(record_to_json(records[0]) == record_to_json(sample_record()));
  CHECK(records[0].training_views == 42);
  CHECK(records[0].metrics.at("psnr") == 31.23456789012345);
  CHECK(records[0].not_applicable == sample_record().not_applicable);
}

TEST_CASE("a failure keeps its stage, kind, message and log") {
  const test::TempFolder folder;
  Record record = sample_record();
  record.metrics.clear();
  record.failure = Failure{"train", "check", "means[7] is not finite", {"{\"iteration\":1}"}};
  append_record(folder.path() / "records.jsonl", record);
  const auto records = read_records(folder.path() / "records.jsonl");
  REQUIRE(records.size() == 1);
  REQUIRE_FALSE(records[0].ok());
  CHECK(records[0].failure->stage == "train");
  CHECK(records[0].failure->message == "means[7] is not finite");
  CHECK(records[0].failure->log_tail == std::vector<std::string>{"{\"iteration\":1}"});
}

TEST_CASE("the last record of a cell wins and keeps the cell's place") {
  const test::TempFolder folder;
  const fs::path file = folder.path() / "records.jsonl";
  Record first = sample_record(), other = sample_record();
  other.cell.seed = 4;
  append_record(file, first);
  append_record(file, other);
  first.metrics["psnr"] = 33;
  append_record(file, first);
  const auto records = read_records(file);
  REQUIRE(records.size() == 2);
  CHECK(records[0].cell == first.cell);
  CHECK(records[0].metrics.at("psnr") == 33);
}

TEST_CASE("a torn last line is skipped, and appending after it loses nothing") {
  const test::TempFolder folder;
  const fs::path file = folder.path() / "records.jsonl";
  append_record(file, sample_record());
  write_file(file, read_file(file) + R"({"scene": "room_2", "meth)");
  CHECK(read_records(file).size() == 1);
  Record next = sample_record();
  next.cell.scene = "room_2";
  append_record(file, next);
  CHECK(read_records(file).size() == 2);
}

TEST_CASE("an older record without later fields reads with defaults, unknown fields are ignored") {
  const Record record =
      record_from_json(Json::parse(R"({"scene":"a","method":"b","future":1})"), "line 1");
  CHECK(record.cell.text() == "a/b/0");
  CHECK(record.ok());
  CHECK(record.metrics.empty());
}

TEST_CASE("a record of schema 1 reads, and has no keys") {
  const Record record = record_from_json(
      Json::parse(R"({"schema":1,"scene":"a","method":"b","config_hash":"c0ffee"})"), "line 1"
  );
  CHECK(record.schema == 1);
  CHECK(record.train_key.empty());
  CHECK(record.score_key.empty());
}

TEST_CASE("records that cannot be trusted are errors naming the line") {
  const test::TempFolder folder;
  const fs::path file = folder.path() / "records.jsonl";
  for (const char* line :
       {R"({"method":"2dgs"})",
        R"({"scene":"a","method":"b","schema":99})",
        R"({"scene":"a","method":"b","seed":"x"})",
        "[1, 2]"}) {
    write_file(file, std::string(line) + "\n");
    CHECK_THROWS_WITH(read_records(file), Catch::Contains("records.jsonl:1"));
  }
}

TEST_CASE("ten thousand records are read in less than two seconds of one core") {
  const test::TempFolder folder;
  const fs::path file = folder.path() / "records.jsonl";
  std::string text;
  for (std::uint64_t seed = 0; seed < 10000; ++seed) {
    Record record = sample_record();
    record.cell.seed = seed % 9000;  // 1,000 cells twice
    text += record_to_json(record).dump() + "\n";
  }
  write_file(file, text);
  const std::clock_t start = std::clock();  // other work on the machine does not count
  CHECK(read_records(file).size() == 9000);
  CHECK(std::clock() - start < 2 * CLOCKS_PER_SEC);
}

TEST_CASE("no file means no records") { CHECK(read_records("does/not/exist.jsonl").empty()); }

TEST_CASE("values that are not finite are left out, not written as null") {
  Record record = sample_record();
  record.metrics["depth-absrel"] = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(record_to_json(record).at("metrics").contains("depth-absrel"));
}

TEST_CASE("records whose names lead out of the results are refused, deeply nested ones skipped") {
  const test::TempFolder folder;
  const fs::path file = folder / "records.jsonl";
  for (const char* names :
       {R"("scene": "../x", "method": "m")",
        R"("scene": "x", "method": "m/../../y")",
        R"("scene": "x", "method": "/y")",
        R"("scene": "", "method": "m")"}) {
    write_file(file, fmt::format("{{{}, \"metrics\": {{}}}}\n", names));
    CHECK_THAT(
        test::error_of(ExitCode::kBadPrediction, [&] { read_records(file); }),
        Catch::Contains("records.jsonl:1: ")
    );
  }
  const std::string deep(100000, '[');
  write_file(
      file,
      "{\"scene\": \"x\", \"method\": \"a/b\", \"metrics\": {}}\n{\"scene\": \"y\", \"x\": " +
          deep + "\n"
  );
  CHECK(read_records(file).size() == 1);
}

TEST_CASE("TOML of any depth is a usage error, not the end of the stack") {
  std::string key = "x";
  for (int i = 0; i < 200'000; ++i) key += ".x";
  for (const std::string& text :
       {key + " = 1\n", "x = " + std::string(200'000, '['), "[" + key + "]\n"})
    test::error_of(ExitCode::kUsage, [&] { json_from_toml(text, "p.toml"); });
  CHECK(json_from_toml("a.b = [0.1, 0.2]", "p.toml")["a"]["b"].size() == 2);
}
