// SPDX-License-Identifier: MIT
// Cells in processes of their own. The processes are this program, told by its environment to run
// one cell: the hidden test case.
#include <unistd.h>
#include <catch2/catch.hpp>

#include <csignal>
#include <cstdlib>

#include "glint/core/progress.h"
#include "reports/executors/executor.h"
#include "reports/records/failure_kinds.h"
#include "reports/verbs/run_options.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

// A profile, and the way to run it: `fails` where room_1's "fake" does (fake_method.h).
struct Pool {
  test::TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  ExecutorOptions how;
  std::string fails;

  Pool() {
    set_quiet(true);
    how.command = [this](const CellKey& cell, bool, int) {
      const bool fake = cell == CellKey{"room_1", "fake", 0};
      return std::vector<std::string>{
          "env",
          "GLINT_TEST_CELL=" + cell.text(),
          "GLINT_TEST_OUT=" + folder.path().string(),
          "GLINT_TEST_FAILS=" + (fake ? fails : std::string()),
          fmt::format("GLINT_TEST_ITERATIONS={}", options.profile.iterations),
          fs::read_symlink("/proc/self/exe").string(),
          "[.worker]"};
    };
  }
  RunSummary run() {
    options.assignments.clear();
    if (!fails.empty()) options.assignments = {"fake.fails=" + fails};
    return find_executor("local").run(options, how);
  }
  std::vector<Record> records() const { return read_records(folder.path() / "records.jsonl"); }
  Failure failure() const {
    const auto all = records();
    const Record* record = find_record(all, {"room_1", "fake", 0});
    REQUIRE(record);
    REQUIRE_FALSE(record->ok());
    return *record->failure;
  }
};

}  // namespace

TEST_CASE("the worker", "[.worker]") {
  set_quiet(true);
  CommonOptions common;
  RunnerOptions options = fake_run(std::getenv("GLINT_TEST_OUT"));
  options.filter.cells = {std::getenv("GLINT_TEST_CELL")};
  options.profile.iterations = std::atoi(std::getenv("GLINT_TEST_ITERATIONS"));
  if (const std::string fails = std::getenv("GLINT_TEST_FAILS"); !fails.empty())
    options.assignments = {"fake.fails=" + fails};
  CellRunOptions how;
  how.executor = "inline";
  std::_Exit(exit_code_of(run_cells(common, how, options)));
}

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
