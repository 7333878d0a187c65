// SPDX-License-Identifier: MIT
// One cell of a fake method, trained and scored, for tests of what is done with it again.
#pragma once

#include <catch2/catch.hpp>
#include <string>

#include "reports/run/bench/cell_stages.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

namespace glint::test {

// And what can be said of it after a run.
struct OneCell {
  TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  fs::path run = folder.path() / "runs/room_1/fake/0";

  explicit OneCell(const std::function<void(RunnerOptions&)>& edit = [](RunnerOptions&) {}) {
    options.filter.only = {"room_1/fake/0"};
    edit(options);
    run_profile(options);
  }
  Record record() const {
    const auto records = read_records(folder.path() / "records.jsonl");
    REQUIRE(records.size() == 1);
    return records[0];
  }
  CellStages stages() const {
    const PlanCell cell = make_plan(options.profile, options.filter, options.assignments)[0];
    const auto records = read_records(folder.path() / "records.jsonl");
    const Record* record = find_record(records, cell.cell);
    return cell_stages(cell, options.profile, options.identify(cell.source), record, run);
  }
  // The stages that a run would do now, then does; `trainings` of them really trained.
  std::string run_again(int trainings) {
    std::string to_do;
    for (const CellStages now = stages(); const Stage stage : kStages)
      if (!now[stage].done) to_do += (to_do.empty() ? "" : " ") + std::string(stage_name(stage));
    const int before = FakeMethod::trainings;
    CHECK(run_profile(options).ran == (to_do.empty() ? 0 : 1));
    CHECK(FakeMethod::trainings - before == trainings);
    CHECK(stages().why() == "");
    return to_do;
  }
};

}  // namespace glint::test
