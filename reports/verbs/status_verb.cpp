// SPDX-License-Identifier: MIT
#include "reports/verbs/status_verb.h"

#include <map>
#include <memory>

#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "reports/run/bench/cell_stages.h"
#include "reports/run/executors/slurm_jobs.h"
#include "reports/run/records/leftovers.h"
#include "reports/run/records/run_folder.h"

namespace glint {

namespace {

struct PlannedCell {
  PlanCell cell;
  CellStages stages;
  const Record* record;  // null: none
};

// `records` must outlive the cells. Errors: as make_plan.
std::vector<PlannedCell> planned_cells(
    const CommonOptions& common, const Profile& profile, const std::vector<Record>& records
) {
  const SceneIdentifier identify = common.scene_identifier();
  const fs::path folder = common.own_folder(profile);
  std::map<std::string, SceneIdentity> scenes;  // by name
  std::vector<PlannedCell> cells;
  for (const PlanCell& cell : make_plan(profile, common.filter(), common.set)) {
    if (!scenes.contains(cell.cell.scene))
      scenes[cell.cell.scene] = identity_or_why(identify, cell.source);
    const Record* record = find_record(records, cell.cell);
    const fs::path run = run_folder(folder, cell.cell);
    cells.push_back({cell, cell_stages(cell, profile, scenes[cell.cell.scene], record, run), record}
    );
  }
  return cells;
}

struct StatusRow {
  CellKey cell;
  CellStages stages;
  std::string state;   // state_of(); "started" and "trained" for cells without a record
  std::string job;     // what a cluster says of its last job: "RUNNING 1234_7 on node3, 12:30"
  std::string detail;  // PSNR of a finished cell, failure, last logged step, what has changed
  std::optional<double> seconds;  // of what is to do, by finished cells of the method
};

// "stale": a record of something else.
std::string state_of(const PlannedCell& cell) {
  if (cell.stages.done()) return "done";
  if (cell.record == nullptr) return "pending";
  return cell.record->ok() ? "stale" : "failed";
}

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

// Of a cell without a record.
void add_progress(const fs::path& run, StatusRow& row) try {
  if (!is_there(run / "config.json")) return;
  row.state = is_there(run / "env.json") ? "trained" : "started";
  row.detail = last_step(run);
} catch (const Error& error) {
  row.detail = error.what();
}

StatusRow status_of(
    const PlannedCell& planned, const fs::path& folder, const std::vector<Record>& records
) {
  const CellStages& stages = planned.stages;
  StatusRow row{planned.cell.cell, stages, state_of(planned), "", stages.why(), {}};
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
  if (row.state == "pending") add_progress(run, row);
  if (!stages.done()) row.seconds = estimated_seconds(planned.cell, records, stages_to_do(stages));
  return row;
}

std::vector<StatusRow> status_rows(
    const std::vector<PlannedCell>& cells,
    const fs::path& folder,
    const std::vector<Record>& records
) {
  const auto states = slurm_states(folder);
  std::vector<StatusRow> rows;
  for (const PlannedCell& planned : cells) {
    rows.push_back(status_of(planned, folder, records));
    if (const auto state = states.find(rows.back().cell.text()); state != states.end())
      rows.back().job = state->second.text();
  }
  return rows;
}

Json stages_json(const CellStages& stages) {
  Json json = Json::object();
  for (const Stage stage : kStages) {
    const StageState& state = stages[stage];
    json[std::string(stage_name(stage))] = {
        {"done", state.done}, {"why", state.why}, {"key", state.key()}};
  }
  return json;
}

// "render, mesh"; of a scene that is not there, data first.
std::string to_do_text(const StatusRow& row) {
  const std::string stages = comma_list(stages_to_do(row.stages));
  return row.stages[Stage::kData].done ? stages : "data, " + stages;
}

Cell estimate_of(const StatusRow& row) {
  if (row.stages.done()) return {Json(), ""};
  return row.seconds ? Cell(*row.seconds, format_duration(*row.seconds)) : Cell(Json(), "unknown");
}

Rows rows_of(const std::vector<StatusRow>& rows) {
  Rows listed(
      {{"", "cell"},
       {"state", "state"},
       {"", "to do"},
       {"estimated_seconds", "estimate"},
       {"detail", "detail"},
       {"job", "job"}},
      "scene method seed stages"
  );
  for (const StatusRow& row : rows)
    listed.add(
        {row.cell.text(),
         row.state,
         to_do_text(row),
         estimate_of(row),
         row.detail,
         row.job,
         row.cell.scene,
         row.cell.method,
         row.cell.seed,
         stages_json(row.stages)}
    );
  return listed;
}

std::string summary_of(const std::vector<StatusRow>& rows) {
  std::map<std::string, int> counts;
  double left = 0;
  for (const StatusRow& row : rows) {
    ++counts[row.state];
    left += row.seconds.value_or(0);
  }
  std::string summary;
  for (const auto& [state, count] : counts)
    summary += fmt::format("{}{} {}", summary.empty() ? "" : ", ", count, state);
  return left > 0 ? summary + "; about " + format_duration(left) + " to go" : summary;
}

std::string status_text(const std::vector<StatusRow>& rows) {
  return rows_of(rows).text() + summary_of(rows) + "\n";
}

struct LeftoverOptions {
  bool list = false, remove = false, unfinished = false;
};

std::string size_text(std::uintmax_t bytes) {
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
}

Rows rows_of(const std::vector<Leftover>& leftovers) {
  Rows rows({{"path"}, {"bytes"}, {"why"}});
  for (const Leftover& leftover : leftovers)
    rows.add({leftover.path.string(), {leftover.bytes, size_text(leftover.bytes)}, leftover.why});
  return rows;
}

std::string leftovers_text(const std::vector<Leftover>& leftovers, bool removed) {
  if (leftovers.empty()) return "nothing is left over\n";
  std::uintmax_t bytes = 0;
  for (const Leftover& leftover : leftovers) bytes += leftover.bytes;
  return rows_of(leftovers).text() +
         fmt::format(
             "{} in all, {}\n",
             size_text(bytes),
             removed ? "removed" : "nothing was removed: that takes --yes"
         );
}

int print_leftovers(const CommonOptions& common, const LeftoverOptions& options) {
  const fs::path folder = profile_folder(common.out, load_profile(common.profile).name);
  const auto leftovers = find_leftovers(folder, options.unfinished);
  if (options.remove)
    for (const Leftover& leftover : leftovers) remove_leftover(leftover);
  print_result(
      common,
      {{"removed", options.remove}, {"leftovers", rows_of(leftovers).json()}},
      leftovers_text(leftovers, options.remove)
  );
  return 0;
}

void add_status_verb(CommandLine& line) {
  auto tasks = std::make_shared<bool>(false);
  auto leftovers = std::make_shared<LeftoverOptions>();
  CLI::App* verb = line.add_verb(
      line.app,
      "status",
      "how far a profile is: which stages of its cells `all` would run, why, and how long",
      [&line, tasks, leftovers] {
        return leftovers->list ? print_leftovers(line.common, *leftovers)
                               : print_status(line.common, *tasks);
      },
      kPlanOptions
  );
  auto* tasks_only = verb->add_flag(
      "--tasks", *tasks, "only the names of the cells that are not done, one a line"
  );
  auto* list = verb->add_flag(
      "--leftovers", leftovers->list, "instead what belongs to no finished cell, as of killed runs"
  );
  list->excludes(tasks_only);
  verb->add_flag("--yes", leftovers->remove, "remove what --leftovers lists")->needs(list);
  const char* unfinished =
      "of --leftovers: also trainings that `all` would go on with, and runs of failed cells";
  verb->add_flag("--unfinished", leftovers->unfinished, unfinished)->needs(list);
}

}  // namespace

int print_status(const CommonOptions& common, bool tasks) {
  const Profile profile = common.resolved_profile();
  const fs::path folder = common.own_folder(profile);
  const auto records = read_records(folder / "records.jsonl");
  const auto cells = planned_cells(common, profile, records);
  if (tasks) {
    for (const PlannedCell& cell : cells)  // for engines that start `all --cell` or `all --tasks`
      if (!cell.stages.done()) print_text(cell.cell.cell.text() + "\n");
    return 0;
  }
  const auto rows = status_rows(cells, folder, records);
  print_result(common, {{"cells", rows_of(rows).json()}}, status_text(rows));
  return 0;
}

GLINT_REGISTER(Verb, {"status", add_status_verb})

}  // namespace glint
