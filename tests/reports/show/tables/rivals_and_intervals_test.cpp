// SPDX-License-Identifier: MIT
// Rows that are no rivals, and intervals of means, in every format.
#include <catch2/catch.hpp>

#include "reports/show/tables/table_writers.h"
#include "reports/show/tables/tables.h"
#include "tests/support/table_parts.h"
#include "tests/support/told_method.h"

using namespace glint;
using namespace glint::test;

namespace {

// Two rooms, one seed.
void add_rooms(std::vector<Record>& records, const std::string& method, double psnr) {
  for (const char* room : {"room_1", "room_2"})
    records.push_back(record_of({room, method, 0}, {{"psnr", psnr}}));
}

}  // namespace

TEST_CASE("a method that was given the truth has no rank, moves nobody's, and stands last") {
  register_told_method();
  std::vector<Record> records;
  add_rooms(records, "told", 99);
  add_rooms(records, "2dgs", 30);
  add_rooms(records, "zzz", 31);
  const TableDefinition definition = definition_of("table1_photometric");
  const Table table = build_table(definition, records);
  CHECK(cell_of(table, "told", "psnr").value == 99);
  CHECK(cell_of(table, "told", "psnr").rank == 0);
  CHECK(cell_of(table, "zzz", "psnr").rank == 1);
  CHECK(cell_of(table, "2dgs", "psnr").rank == 2);
  CHECK(table.rows.back().title == "Told‡");
  const std::string note = "‡ Told: no rival: given the true pane; not ranked.";
  CHECK_THAT(table_markdown(table), Catch::Contains("| Told‡ | 99.00 |") && Catch::Contains(note));
  CHECK_THAT(table_terminal(table, {false, 0, true}), Catch::Contains(note));
  CHECK_THAT(table_latex(table), Catch::Contains("\\midrule\nTold$^\\ddagger$ & 99.00 &"));
  CHECK_THAT(table_csv(table), Catch::Contains("\ntold,99,") && Catch::Contains(",psnr\n"));
  CHECK(table_json(table)["rows"].back()["rival"] == false);
  CHECK_FALSE(table_json(table)["rows"][0].contains("rival"));
}

TEST_CASE("a method that was given the truth has no say in the scenes of means") {
  register_told_method();
  std::vector<Record> records;
  add_rooms(records, "told", 99);
  add_rooms(records, "2dgs", 30);
  records.pop_back();  // room_1 alone
  const Table table = build_table(definition_of("table1_photometric"), records);
  CHECK(cell_of(table, "2dgs", "psnr").status == CellStatus::kOk);
  CHECK(cell_of(table, "2dgs", "psnr").rank == 0);  // nobody to rank against
  CHECK(cell_of(table, "told", "psnr").num_scenes == 1);
  records.resize(2);
  CHECK(
      cell_of(build_table(definition_of("table1_photometric"), records), "told", "psnr").value == 99
  );
}

TEST_CASE("means have an interval over scenes and seeds in every format, from three pairs on") {
  std::vector<Record> records;
  const auto add = [&](const char* room, std::uint64_t seed, double psnr) {
    records.push_back(record_of({room, "2dgs", seed}, {{"psnr", psnr}}));
  };
  const auto table = [&] { return build_table(definition_of("table1_photometric"), records); };
  add("a", 0, 30);
  add("b", 0, 30);
  CHECK_FALSE(cell_of(table(), "2dgs", "psnr").interval.has_value());
  CHECK_THAT(table_markdown(table()), !Catch::Contains("bootstrap over"));
  add("c", 0, 30);  // all alike: no width
  const Interval alike = cell_of(table(), "2dgs", "psnr").interval.value();
  CHECK(alike.low == Approx(30).epsilon(1e-12));
  CHECK(alike.high == Approx(30).epsilon(1e-12));
  CHECK_THAT(table_markdown(table()), Catch::Contains("95 % by bootstrap over scenes, too narrow"));
  for (const char* room : {"a", "b", "c"}) add(room, 1, 32);
  const Table both = table();
  const Interval interval = cell_of(both, "2dgs", "psnr").interval.value();
  CHECK(interval.low >= 30);
  CHECK(interval.high <= 32);
  CHECK(interval.low < 31);
  CHECK(interval.high > 31);
  const std::string text = fmt::format("[{:.2f}, {:.2f}]", interval.low, interval.high);
  CHECK_THAT(table_markdown(both), Catch::Contains("| 31.00 ± 2.00<br>" + text + " |"));
  CHECK_THAT(table_terminal(both), Catch::Contains("31.00 ± 2.00 " + text));
  CHECK_THAT(table_latex(both), Catch::Contains("31.00 $\\pm$ 2.00 {\\scriptsize " + text + "}"));
  CHECK(table_json(both)["rows"][0]["cells"]["psnr"]["interval"].size() == 2);
  CHECK_THAT(table_markdown(both), Catch::Contains("95 % by bootstrap over scenes and seeds"));
  CHECK_THAT(table_terminal(both, {false, 0, true}), !Catch::Contains(text));
}

TEST_CASE("a table of short runs says so first") {
  std::vector<Record> records;
  add_rooms(records, "2dgs", 30);
  const TableDefinition definition = definition_of("table1_photometric");
  const auto table_of = [&](int steps) {
    for (Record& record : records) record.iterations = steps;
    return build_table(definition, records);
  };
  CHECK(table_of(3000).caption.starts_with("A smoke test: 3000 steps, "));
  CHECK_THAT(table_terminal(table_of(3000), {}), Catch::Contains("(a smoke test: 3000 steps)"));
  for (const int steps : {8000, 0}) {  // 0: unknown
    CHECK(table_of(steps).caption == definition.caption);
    CHECK(table_of(steps).title == definition.title);
  }
}
