// SPDX-License-Identifier: MIT
#include "reports/show/tables/order_by_length.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "reports/show/tables/published.h"
#include "tests/support/table_parts.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

const std::vector<std::string> kMethods = {"2dgs", "pgsr", "ref-gs", "envgs", "tsgs", "glint"};

double published_psnr(const std::string& row) {
  return find_published("1", "3D-FRONT-T", row, "PSNR")->value;
}

// Three rooms of every method, in the paper's order of PSNR or, from some step on, against it.
RecordsOfFile file_of(const std::string& name, int steps, bool agrees, std::size_t methods = 6) {
  const std::vector<std::string> rows = {"2DGS", "PGSR", "Ref-GS", "EnvGS", "TSGS", "GLINT"};
  RecordsOfFile file{name, 0, {}};
  for (std::size_t i = 0; i < methods; ++i)
    for (const char* room : {"room_1", "room_2", "room_3"}) {
      const double psnr = published_psnr(rows[i]);
      Record record = record_of({room, kMethods[i], 0}, {{"psnr", agrees ? psnr : -psnr}});
      record.resolution = "240x135";
      record.iterations = steps;
      file.records.push_back(record);
    }
  return file;
}

bool is_left_out(const OrderByLength& order, const std::string& text) {
  return std::any_of(order.left_out.begin(), order.left_out.end(), [&](const std::string& why) {
    return why.find(text) != std::string::npos;
  });
}

}  // namespace

TEST_CASE("each length with the six methods is a point, with its tau and interval") {
  const OrderByLength order = order_by_length(std::vector{
      file_of("short.jsonl", 1000, false), file_of("long.jsonl", 30000, true)});
  REQUIRE(order.points.size() == 2);
  CHECK(order.points[0].steps == 1000);
  CHECK(order.points[0].mean.tau == Approx(-1));
  CHECK(order.points[1].steps == 30000);
  CHECK(order.points[1].mean.tau == Approx(1));
  CHECK(order.points[1].mean.interval->low == Approx(1));
  CHECK(order.points[1].mean.chance.high == Approx(1 - 4 * 2 / 30.0));  // one column: as it alone
  CHECK(order.points[1].num_scenes == 3);
  CHECK(order.points[1].records == "long.jsonl");
  REQUIRE(order.points[1].columns.size() == 1);
  CHECK(order.points[1].columns[0].column == "psnr");
  CHECK(order.left_out.empty());
  const std::string text = order_markdown(order);
  for (const char* part : {"| 1000 |", "| 30000 |", "-1.00 [-1.00, -1.00]", "order_by_length.svg"})
    CHECK_THAT(text, Catch::Contains(part));
}

TEST_CASE("lengths without all six methods are left out, and it is said which they lack") {
  const OrderByLength order = order_by_length(std::vector{file_of("few.jsonl", 7000, true, 4)});
  CHECK(order.points.empty());
  CHECK(is_left_out(order, "7000 steps at 240x135 (few.jsonl): lacks TSGS, GLINT"));
  CHECK_THAT(order_markdown(order), Catch::Contains("Left out: 7000 steps"));
}

TEST_CASE("of two files of one length the one with more rooms and seeds counts") {
  RecordsOfFile small = file_of("small.jsonl", 3000, false);
  std::erase_if(small.records, [](const Record& record) { return record.cell.scene != "room_1"; });
  for (const auto& files :
       {std::vector{small, file_of("large.jsonl", 3000, true)},
        std::vector{file_of("large.jsonl", 3000, true), small}}) {
    const OrderByLength order = order_by_length(files);
    REQUIRE(order.points.size() == 1);
    CHECK(order.points[0].records == "large.jsonl");
    CHECK(is_left_out(order, "small.jsonl): large.jsonl has more rooms and seeds"));
  }
}

TEST_CASE("of two files of one length with as many rooms and seeds the first counts") {
  const OrderByLength order = order_by_length(std::vector{
      file_of("first.jsonl", 3000, false), file_of("second.jsonl", 3000, true)});
  REQUIRE(order.points.size() == 1);
  CHECK(order.points[0].records == "first.jsonl");
  const char* why = "second.jsonl): first.jsonl has as many rooms and seeds, and stands first";
  CHECK(is_left_out(order, why));
}

TEST_CASE("scenes with few photos and with many are points and lines of their own") {
  RecordsOfFile few = file_of("few.jsonl", 8000, false), many = file_of("many.jsonl", 8000, true);
  few.photos = 42;  // the records do not say
  for (Record& record : many.records) record.training_views = 155;
  std::erase_if(many.records, [](const Record& record) { return record.cell.scene != "room_1"; });
  const OrderByLength order = order_by_length(std::vector{few, many});
  REQUIRE(order.points.size() == 2);
  CHECK(order.points[0].records == "few.jsonl");
  CHECK(order.points[0].measured_on() == "3 rooms, 1 seed, 42 photos");
  CHECK(order.points[0].series() == order.points[0].title + ", few photos");
  CHECK(order.points[1].measured_on() == "1 room, 1 seed, 155 photos");
  CHECK(order.points[1].series() == order.points[1].title + ", many photos");
  CHECK(order.left_out.empty());
}

TEST_CASE("scenes of a file may differ in their photos") {
  RecordsOfFile file = file_of("mixed.jsonl", 8000, true);
  for (Record& record : file.records)
    record.training_views = record.cell.scene == "room_1" ? 148 : 155;
  const OrderByLength order = order_by_length(std::vector{file});
  REQUIRE(order.points.size() == 1);
  CHECK(order.points[0].measured_on() == "3 rooms, 1 seed, 148 to 155 photos");
}

TEST_CASE("a file's own photos go before those of the list") {
  RecordsOfFile file = file_of("own.jsonl", 8000, true);
  file.photos = 42;
  for (Record& record : file.records) record.training_views = 155;
  CHECK(order_by_length(std::vector{file}).points.at(0).photos == 155);
}

TEST_CASE("a method may have been trained longer, as the paper's GLINT is") {
  RecordsOfFile file = file_of("long.jsonl", 30000, true);
  for (Record& record : file.records)
    if (record.cell.method == "glint") record.iterations = 60000;
  const OrderByLength order = order_by_length(std::vector{file});
  REQUIRE(order.points.size() == 1);
  CHECK(order.points[0].steps == 30000);
  CHECK(order.points[0].longer == std::vector<std::string>{"GLINT 60000 steps"});
  CHECK_THAT(order_markdown(order), Catch::Contains("At 30000 steps: GLINT 60000 steps."));
}

TEST_CASE("records that do not say their steps have the file's, or do not count") {
  RecordsOfFile file = file_of("old.jsonl", 0, true);
  CHECK(order_by_length(std::vector{file}).points.empty());
  file.steps = 3000;
  CHECK(order_by_length(std::vector{file}).points.at(0).steps == 3000);
}

TEST_CASE("a list of lengths that is none is refused") {
  const TempFolder root;
  write_file(
      root / "docs/results/parts/1.json", R"({"records": "r.jsonl", "command": "c", "title": "t"})"
  );
  write_file(root / "r.jsonl", "");
  CHECK(order_by_length(root.path()).points.empty());
  for (const char* bad : {"{}", "[1]", "[{\"steps\": 3}]", "[{\"records\": \"gone.jsonl\"}]"}) {
    write_file(root / "docs/results/lengths.json", bad);
    bad_reference([&] { order_by_length(root.path()); });
  }
}
