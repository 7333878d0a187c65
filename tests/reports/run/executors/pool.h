// SPDX-License-Identifier: MIT
// Cells in processes of their own. The processes are the test's program, told by its environment to
// run one cell: a hidden test case that calls run_worker().
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <sstream>

#include "glint/core/progress.h"
#include "reports/run/executors/executor.h"
#include "reports/verbs/run_options.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

namespace glint::test {

inline std::vector<std::string> lines_of_file(const fs::path& file) {
  std::vector<std::string> lines;
  if (!fs::exists(file)) return lines;
  std::istringstream text(read_file(file));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

// TEST_CASE("the worker", "[.worker]") { test::run_worker(); }
inline void run_worker() {
  set_quiet(true);
  CommonOptions common;
  common.device = "cpu";
  RunnerOptions options = fake_run(std::getenv("GLINT_TEST_OUT"));
  options.filter.cells = {std::getenv("GLINT_TEST_CELL")};
  options.profile.iterations = std::atoi(std::getenv("GLINT_TEST_ITERATIONS"));
  if (const std::string fails = std::getenv("GLINT_TEST_FAILS"); !fails.empty())
    options.assignments = {"fake.fails=" + fails};
  CellRunOptions how;
  how.executor = "inline";
  append_line(options.out / "events", "begin");
  const int code = exit_code_of(run_cells(common, how, options));
  append_line(options.out / "events", "end");
  std::_Exit(code);
}

// A profile, and the way to run it: `fails` where room_1's "fake" does (fake_method.h). In
// OUT/begun a line for each process: its cell and what its environment says of the card.
struct Pool {
  TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  ExecutorOptions how;
  std::string fails;

  Pool() {
    set_quiet(true);
    how.command = [this](const CellKey& cell, bool, const ProcessShare&) { return words(cell); };
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
  std::vector<std::string> begun() const { return lines_of_file(folder / "begun"); }
  // Cells that ran at the same time, since the file was last removed.
  int most_at_once() const {
    int now = 0, most = 0;
    for (const std::string& line : lines_of_file(folder / "events"))
      most = std::max(most, now += line == "begin" ? 1 : -1);
    return most;
  }

 private:
  std::vector<std::string> words(const CellKey& cell) const {
    const bool fake = cell == CellKey{"room_1", "fake", 0};
    return {
        "env",
        "GLINT_TEST_CELL=" + cell.text(),
        "GLINT_TEST_OUT=" + folder.path().string(),
        "GLINT_TEST_FAILS=" + (fake ? fails : std::string()),
        fmt::format("GLINT_TEST_ITERATIONS={}", options.profile.iterations),
        "sh",
        "-c",
        R"sh(echo "$GLINT_TEST_CELL jobs=$GLINT_CARD_JOBS mps=$CUDA_MPS_PIPE_DIRECTORY" \
             >>"$GLINT_TEST_OUT/begun"; exec "$0" "[.worker]")sh",
        fs::read_symlink("/proc/self/exe").string()};
  }
};

}  // namespace glint::test
