// SPDX-License-Identifier: MIT
#include <map>

#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "reports/executors/slurm_jobs.h"
#include "reports/records/run_folder.h"
#include "reports/verbs/planned_cells.h"

namespace glint {

namespace {

struct StatusRow {
  CellKey cell;
  std::string state;   // PlannedCell's; "started" and "trained" for cells without a record
  std::string job;     // what a cluster says of its last job: "RUNNING 1234_7 on node3, 12:30"
  std::string detail;  // PSNR of a finished cell, failure, last logged step, what has changed
};

// The last step that an unfinished run logged; empty when there is none.
std::string last_step(const fs::path& run) {
  for (const std::string& line : log_tail(run, 1)) {
    const Json json = parse_json(line);
    if (json.is_object())
      return fmt::format(
          "step {:.0f}, PSNR {:.2f}", number_or(json, "iteration", 0), number_or(json, "psnr", 0)
      );
  }
  return "";
}

StatusRow status_of(const PlannedCell& planned, const fs::path& folder) {
  StatusRow row{planned.cell.cell, planned.state(), "", planned.stages.why()};
  if (row.state == "done" && planned.record->metrics.count("psnr"))
    row.detail = fmt::format("PSNR {:.2f}", planned.record->metrics.at("psnr"));
  if (row.state == "failed")
    row.detail = fmt::format(
        "{} ({}): {}",
        planned.record->failure->stage,
        planned.record->failure->kind,
        planned.record->failure->message
    );
  const fs::path run = run_folder(folder, row.cell);
  if (row.state == "pending" && fs::exists(run / "config.json")) {
    row.state = fs::exists(run / "env.json") ? "trained" : "started";
    row.detail = last_step(run);
  }
  return row;
}

Rows rows_of(const std::vector<StatusRow>& rows) {
  Rows listed({{""}, {"state"}, {"detail"}, {"job"}}, "scene method seed");
  for (const auto& [cell, state, job, detail] : rows)
    listed.add({cell.text(), state, detail, job, cell.scene, cell.method, cell.seed});
  return listed;
}

std::string status_text(const std::vector<StatusRow>& rows) {
  std::map<std::string, int> counts;
  for (const StatusRow& row : rows) ++counts[row.state];
  std::string summary;
  for (const auto& [state, count] : counts)
    summary += fmt::format("{}{} {}", summary.empty() ? "" : ", ", count, state);
  return rows_of(rows).text() + summary + "\n";
}

int run_status(const CommonOptions& common) {
  const Profile profile = common.resolved_profile();
  const fs::path folder = common.own_folder(profile);
  const auto records = read_records(folder / "records.jsonl");
  const auto states = slurm_states(folder);
  std::vector<StatusRow> rows;
  for (const PlannedCell& planned : planned_cells(common, profile, records)) {
    rows.push_back(status_of(planned, folder));
    if (const auto state = states.find(rows.back().cell.text()); state != states.end())
      rows.back().job = state->second.text();
  }
  if (common.json)
    print_json({{"cells", rows_of(rows).json()}});
  else
    print_text(status_text(rows));
  return 0;
}

void add_status_verb(CommandLine& line) {
  line.add_verb(
      line.app,
      "status",
      "how far a profile is",
      [&line] { return run_status(line.common); },
      kPlanOptions
  );
}

}  // namespace

GLINT_REGISTER(Verb, {"status", add_status_verb})

}  // namespace glint
