// SPDX-License-Identifier: MIT
// Cells in processes of their own (pool.h).
#include <catch2/catch.hpp>

#include "reports/run/records/failure_kinds.h"
#include "tests/reports/run/executors/pool.h"
#include "tests/reports/run_words.h"

using namespace glint;
using test::Pool;

TEST_CASE("the worker", "[.worker]") { test::run_worker(); }

TEST_CASE("cells in processes have the records that they have in one process") {
  Pool pool;
  pool.how.jobs = GENERATE(1, 3);
  const RunSummary summary = pool.run();
  CHECK(summary.ran == 4);
  CHECK(summary.failed == 0);
  const test::TempFolder folder;
  find_executor("inline").run(fake_run(folder.path()), {});
  const auto expected = read_records(folder.path() / "records.jsonl"), found = pool.records();
  REQUIRE(found.size() == 4);
  for (const Record& record : expected) {
    const Record* same = find_record(found, record.cell);
    REQUIRE(same);
    CHECK(same->metrics.at("psnr") == record.metrics.at("psnr"));
    CHECK(same->score_key == record.score_key);
  }
  CHECK(pool.run().reused == 4);
}

TEST_CASE("a crash ends one cell, which is tried once more and then recorded") {
  Pool pool;
  pool.fails = "abort";
  const RunSummary summary = pool.run();
  CHECK(summary.failed == 1);
  CHECK(summary.ran == 3);
  const Failure failure = pool.failure();
  CHECK(failure.kind == failure::kCrash);
  CHECK(failure.stage == "train");
  CHECK(failure.attempts == 2);
  CHECK_THAT(failure.message, Catch::StartsWith("SIGABRT; its last words: "));
  REQUIRE_FALSE(failure.output_tail.empty());
  CHECK(failure.iteration == 4);  // what its log says
  CHECK(exit_code_of(summary) == 5);
}

TEST_CASE("what crashes once is done at the second try") {
  Pool pool;
  pool.fails = "abort once";
  const RunSummary summary = pool.run();
  CHECK(summary.failed == 0);
  CHECK(summary.ran == 4);
  CHECK(exit_code_of(summary) == 0);
}

TEST_CASE("failures are recorded under their kinds") {
  const std::pair<const char*, std::string_view> cases[] = {
      {"memory", failure::kOutOfMemory},
      {"full", failure::kDiskFull},
      {"weights", failure::kMissingWeights},
      {"loss", failure::kNotFinite},
      {"step", failure::kUnknown},
      {"kill", failure::kCrash},
      {"term", failure::kPreempted}};
  for (const auto& [place, kind] : cases) {
    INFO(place);
    Pool pool;
    pool.options.filter.only = {"room_1/fake/0"};
    pool.fails = place;
    CHECK(pool.run().failed == 1);
    CHECK(pool.failure().kind == kind);
    CHECK(pool.failure().attempts == failure_kind_of(kind).retries + 1);
  }
}

// Alone: how long the others take is the machine's matter.
TEST_CASE("a cell that takes longer than the limit is stopped") {
  Pool pool;
  pool.fails = "slow";
  pool.options.profile.iterations = 1000;
  pool.options.filter.only = {"room_1/fake/0"};
  pool.how.time_limit = 1.5;
  CHECK(pool.run().failed == 1);
  CHECK(pool.failure().kind == failure::kTimeout);
  CHECK(pool.failure().message == "stopped after 1.5s (--time-limit)");
}

TEST_CASE("after so many failures no cell begins") {
  Pool pool;
  pool.fails = "step";
  pool.how.max_failures = 1;
  const RunSummary summary = pool.run();
  CHECK(summary.failed == 1);
  CHECK(summary.ran == 0);
  CHECK(summary.not_begun == 3);
  CHECK(exit_code_of(summary) == 5);
}

TEST_CASE("a failed cell is run again by the next run, the others are reused") {
  Pool pool;
  pool.fails = "step";
  CHECK(pool.run().failed == 1);
  const RunSummary second = pool.run();
  CHECK(second.failed == 1);
  CHECK(second.reused == 3);
}

// A record of a cell of room_2 that took so long.
void write_timed(const Pool& pool, const std::string& method, double seconds) {
  Record record;
  record.profile = "fake";
  record.cell = {"room_9", method, 0};
  record.timings = {{"train", seconds}};
  append_record(pool.folder / "records.jsonl", record);
}

TEST_CASE("no cell begins that is known to take longer than the time for all") {
  Pool pool;
  pool.how.jobs = GENERATE(1, 2);
  pool.how.time_for_all = 100;
  write_timed(pool, "fake", 200);  // of fake/other nothing is known
  const RunSummary summary = pool.run();
  CHECK(summary.ran == 2);
  CHECK(summary.not_begun == 2);
  CHECK(summary.failed == 0);
  CHECK(exit_code_of(summary) == 5);
  for (const std::string& line : pool.begun()) CHECK_THAT(line, Catch::Contains("fake/other"));
}

TEST_CASE("a time too short for any cell is told with what the shortest takes") {
  Pool pool;
  pool.how.time_for_all = 60;
  write_timed(pool, "fake", 200);
  write_timed(pool, "fake/other", 130);
  const std::string said = test::captured(2, [&] { CHECK(pool.run().not_begun == 4); });
  CHECK(
      said ==
      "warning: --for 1m 00s is too short for any of 4 cells: room_1/fake/other/0 takes about 2m "
      "10s\n"
  );
  CHECK(pool.begun().empty());
}

TEST_CASE("when the time is up, running cells stop, and no record says so") {
  Pool pool;
  pool.fails = "slow";
  pool.options.profile.iterations = 10000;
  pool.options.filter.only = {"room_1/fake/0"};
  pool.how.time_for_all = 1.5;
  const RunSummary summary = pool.run();
  CHECK(summary.ran == 0);
  CHECK(summary.failed == 0);
  CHECK(summary.not_begun == 1);
  CHECK_FALSE(summary.interrupted);
  CHECK(exit_code_of(summary) == 5);
  CHECK(pool.records().empty());
  CHECK(pool.begun().size() == 1);
}

TEST_CASE("cells begin in the order that is given, the longest first, or as the profile has them") {
  Pool pool;
  write_timed(pool, "fake", 10);
  write_timed(pool, "fake/other", 20);
  const auto cells_of = [&] {
    std::string cells;
    for (const std::string& line : pool.begun()) cells += line.substr(0, line.find(' ')) + " ";
    return cells;
  };
  SECTION("as given") {
    pool.options.filter.cells = {"room_2/fake/0", "room_1/fake/other/0", "room_1/fake/0"};
    pool.run();
    CHECK(cells_of() == "room_2/fake/0 room_1/fake/other/0 room_1/fake/0 ");
  }
  SECTION("as the profile has them") {
    pool.run();
    CHECK(cells_of() == "room_1/fake/0 room_1/fake/other/0 room_2/fake/0 room_2/fake/other/0 ");
  }
  SECTION("the longest first") {
    pool.how.order = CellOrder::kLongest;
    pool.run();
    CHECK(cells_of() == "room_1/fake/other/0 room_2/fake/other/0 room_1/fake/0 room_2/fake/0 ");
  }
}

TEST_CASE("what ran out of memory is tried again alone, behind the others") {
  Pool pool;
  pool.fails = "memory";
  pool.how.jobs = 2;
  CHECK(pool.run().failed == 1);
  CHECK(pool.failure().attempts == 2);
  const auto begun = pool.begun();
  REQUIRE(begun.size() == 5);
  CHECK_THAT(begun.back(), Catch::StartsWith("room_1/fake/0 "));
}

TEST_CASE("cells that are named are the profile's, or of methods that are asked for") {
  register_fake_methods();
  const test::TempFolder folder;
  CommonOptions common;
  common.profile = (folder / "named.toml").string();
  write_file(
      common.profile,
      "methods = [\"fake\"]\nscenes = [{scene = \"room_1\", dataset = \"a\", folder = \"b\"}]\n"
  );
  CellRunOptions how;
  how.cells = {"room_1/fake/0"};
  CHECK(runner_options(common, how).filter.cells == how.cells);
  how.cells_file = (folder / "cells").string();
  write_file(how.cells_file, "room_1/fake/other/0\t12\n\n");
  CHECK_THROWS_WITH(runner_options(common, how), Catch::Contains("cell room_1/fake/other/0: "));
  common.methods = {"fake/*"};
  common.only = {"*/fake/other/*"};
  CHECK(runner_options(common, how).filter.cells.size() == 2);
  how.cells = {"rom_1/fake/0"};
  CHECK_THROWS_WITH(runner_options(common, how), Catch::Contains("did you mean 'room_1/fake/0'?"));
}

TEST_CASE("in this process there is neither time nor order of cells") {
  Pool pool;
  pool.how.time_for_all = 5;
  CHECK_THROWS_WITH(
      find_executor("inline").run(pool.options, pool.how), Catch::Contains("--for and --order")
  );
}

TEST_CASE("unknown executors and times are usage errors that say what there is") {
  CHECK_THROWS_WITH(find_executor("locl"), Catch::Contains("did you mean 'local'?"));
  CHECK(parse_duration("--time-limit", "90") == 90);
  CHECK(parse_duration("--time-limit", "1.5m") == 90);
  CHECK(parse_duration("--time-limit", "2h") == 7200);
  for (const char* wrong : {"soon", "-3s", "0", "3 s", "nan", "1e99h"})
    CHECK_THROWS_WITH(
        parse_duration("--time-limit", wrong), Catch::Contains("expected a time as 90s")
    );
}
