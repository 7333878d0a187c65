// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>
#include <memory>
#include <tuple>

#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "reports/perf/perf.h"
#include "reports/verbs/planned_cells.h"

namespace glint {

namespace {

struct PlanRow {
  PlannedCell planned;
  std::optional<double> seconds;  // estimated, of what is to do
  std::string from;               // "records", "timed steps"; empty: unknown
};

constexpr int kTimedSteps = 2;

// Steps of each method at each image size, timed once; methods of which nothing is known yet. Not
// what comes behind the training.
class StepTimer {
 public:
  explicit StepTimer(const Profile& profile) : iterations_(profile.iterations) {}

  // Of the cell's training; nothing: its data are a folder's, whose size is not known here.
  std::optional<double> training_seconds(const PlanCell& cell) {
    if (!cell.source.made()) return std::nullopt;
    const Key key{cell.cell.method, cell.source.width, cell.source.height};
    if (!steps_.contains(key)) steps_[key] = time_step(cell);
    return steps_[key] * iterations_;
  }

 private:
  using Key = std::tuple<std::string, int, int>;

  static double time_step(const PlanCell& cell) {
    PerfOptions options;
    options.width = cell.source.width, options.height = cell.source.height;
    options.surfels = static_cast<std::size_t>(options.width * options.height / kPixelsPerSurfel);
    options.runs = kTimedSteps;
    log::info(fmt::format("timing steps of {}", cell.cell.method));
    return seconds_of_step(cell.cell.method, cell.config, options);
  }

  int iterations_;
  std::map<Key, double> steps_;
};

// From earlier cells of the method where there are any, else from timed steps.
PlanRow plan_row(const PlannedCell& cell, const std::vector<Record>& records, StepTimer& timer) {
  PlanRow row{cell, std::nullopt, ""};
  if (cell.stages.done()) return row;
  row.seconds = estimated_seconds(cell.cell, records, stages_to_do(cell.stages));
  if (row.seconds) {
    row.from = "records";
  } else if (!cell.stages[Stage::kTrain].done) {
    row.seconds = timer.training_seconds(cell.cell);
    if (row.seconds) row.from = "timed steps";
  }
  return row;
}

std::vector<PlanRow> plan_rows(
    const std::vector<PlannedCell>& cells,
    const std::vector<Record>& records,
    const Profile& profile
) {
  StepTimer timer(profile);
  std::vector<PlanRow> rows;
  for (const PlannedCell& cell : cells) rows.push_back(plan_row(cell, records, timer));
  return rows;
}

std::vector<std::string> plan_line(const PlanRow& row) {
  std::vector<std::string> line{row.planned.cell.cell.text()};
  for (const Stage stage : kStages)
    line.emplace_back(row.planned.stages[stage].done ? "done" : "to do");
  const bool done = row.planned.stages.done();
  line.push_back(done ? "" : row.seconds ? format_duration(*row.seconds) : "unknown");
  return line;
}

std::string table_text(const std::vector<PlanRow>& rows) {
  std::vector<std::vector<std::string>> lines{{"cell"}};
  for (const Stage stage : kStages) lines[0].emplace_back(stage_name(stage));
  lines[0].emplace_back("estimate");
  for (const PlanRow& row : rows) lines.push_back(plan_line(row));
  lines[0].emplace_back("why");
  for (std::size_t i = 0; i < rows.size(); ++i)
    lines[i + 1].push_back(rows[i].planned.stages.why());
  return aligned_rows(lines);
}

std::string plan_text(const std::vector<PlanRow>& rows) {
  double left = 0;
  bool timed = false;
  for (const PlanRow& row : rows) {
    left += row.seconds.value_or(0);
    timed = timed || row.from == "timed steps";
  }
  const auto todo = std::count_if(rows.begin(), rows.end(), [](const PlanRow& row) {
    return !row.planned.stages.done();
  });
  std::string time = left > 0 ? "about " + format_duration(left) : "time unknown";
  if (timed) time += " (training alone where nothing has run yet, from timed steps)";
  return table_text(rows) +
         fmt::format(
             "{} of {} cells to run{}\n", todo, rows.size(), todo > 0 ? ", " + time : std::string()
         );
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

Json plan_json(const std::vector<PlanRow>& rows) {
  Json json = Json::array();
  for (const PlanRow& row : rows)
    json.push_back(
        {{"scene", row.planned.cell.cell.scene},
         {"method", row.planned.cell.cell.method},
         {"seed", row.planned.cell.cell.seed},
         {"state", row.planned.state()},
         {"stages", stages_json(row.planned.stages)},
         {"estimated_seconds", row.seconds ? Json(*row.seconds) : Json()},
         {"estimated_from", row.from.empty() ? Json() : Json(row.from)}}
    );
  return {{"cells", json}};
}

// For engines that start `run --cell` or `run --tasks`.
int print_tasks(const std::vector<PlannedCell>& cells) {
  std::string text;
  for (const PlannedCell& cell : cells)
    if (!cell.stages.done()) text += cell.cell.cell.text() + "\n";
  print_text(text);
  return 0;
}

int run_plan(const CommonOptions& common, bool tasks) {
  const Profile profile = common.resolved_profile();
  const auto records = read_records(common.records_file(profile));
  if (tasks) return print_tasks(planned_cells(common, profile, records));
  const auto rows = plan_rows(planned_cells(common, profile, records), records, profile);
  if (common.json)
    print_json(plan_json(rows));
  else
    print_text(plan_text(rows));
  return 0;
}

void add_plan_verb(CommandLine& line) {
  auto tasks = std::make_shared<bool>(false);
  CLI::App* verb = line.add_verb(
      line.app,
      "plan",
      "list the cells that `all` would run: which stages are done, and why the others are not",
      [&line, tasks] { return run_plan(line.common, *tasks); },
      kPlanOptions
  );
  verb->add_flag("--tasks", *tasks, "only the names of the cells that are not done, one a line");
}

}  // namespace

GLINT_REGISTER(Verb, {"plan", add_plan_verb})

}  // namespace glint
