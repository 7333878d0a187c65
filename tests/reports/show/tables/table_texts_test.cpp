// SPDX-License-Identifier: MIT
// What tables say beside their values, and how they write large ones.
#include <catch2/catch.hpp>

#include <algorithm>
#include <set>

#include "reports/show/tables/table_cells.h"
#include "reports/show/tables/table_writers.h"

using namespace glint;

TEST_CASE("a note that several methods share is one line") {
  auto records = read_records("tests/reports/golden/records.jsonl");
  for (const char* method : {"one", "two"}) {
    Record record = records[1];
    record.cell = {"room_1", method, 0};
    record.notes = {"seen from afar"};
    record.metrics = {{"psnr-8bit", 30}};
    records.push_back(record);
  }
  const Table table = build_table(table_definitions().front(), records);
  const auto count = [&](const std::string& line) {
    return std::count(table.notes.begin(), table.notes.end(), line);
  };
  CHECK(count("one, two: seen from afar.") == 1);
  CHECK(count("* one, two: of 8-bit images (psnr-8bit); not ranked.") == 1);
}

TEST_CASE("huge values and spreads have an exponent") {
  CHECK(format_value(9999999, 2) == "9999999.00");
  CHECK(format_value(-12345678, 2) == "-1.235e+07");
  TableCell cell;
  cell.status = CellStatus::kOk;
  cell.text = format_value(2e12, 3);
  cell.num_seeds = 2;
  cell.spread = 1e12;
  CHECK(shown_text(cell, {}) == "2.000e+12 ± 1.000e+12");
}

TEST_CASE("there is a column of GPU memory where one was measured") {
  auto records = read_records("tests/reports/golden/records.jsonl");
  const auto titles = [&] {
    std::set<std::string> titles;
    for (const TableDefinition& definition : table_definitions())
      if (definition.id == "tableB_cost")
        for (const TableColumn& column : build_table(definition, records).columns)
          titles.insert(column.title);
    return titles;
  };
  CHECK(titles().contains("Peak memory"));
  CHECK_FALSE(titles().contains("GPU memory"));
  records[1].metrics["device-memory"] = 512;
  CHECK(titles().contains("GPU memory"));
}
