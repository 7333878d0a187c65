// SPDX-License-Identifier: MIT
#include <algorithm>
#include <sstream>

#include "glint/core/progress.h"
#include "reports/verbs/planned_cells.h"

namespace glint {

namespace {

struct PlanRow {
  PlannedCell planned;
  double seconds = 0;  // estimated, of what is to do; 0: unknown
};

std::vector<std::string> stages_to_do(const CellStages& stages) {
  std::vector<std::string> names;
  for (const Stage stage : kStages)
    if (!stages[stage].done && stage != Stage::kData) names.emplace_back(stage_name(stage));
  return names;
}

std::vector<PlanRow> plan_rows(
    const std::vector<PlannedCell>& cells, const std::vector<Record>& records
) {
  std::vector<PlanRow> rows;
  for (const PlannedCell& cell : cells)
    rows.push_back({cell, estimated_seconds(cell.cell, records, stages_to_do(cell.stages))});
  return rows;
}

std::vector<std::string> plan_line(const PlanRow& row) {
  std::vector<std::string> line{row.planned.cell.cell.text()};
  for (const Stage stage : kStages)
    line.emplace_back(row.planned.stages[stage].done ? "done" : "to do");
  const bool done = row.planned.stages.done();
  line.push_back(done ? "" : row.seconds > 0 ? format_duration(row.seconds) : "unknown");
  return line;
}

// The aligned lines, and behind each cell's why it is not done.
std::string table_text(const std::vector<PlanRow>& rows) {
  std::vector<std::vector<std::string>> lines{{"cell"}};
  for (const Stage stage : kStages) lines[0].emplace_back(stage_name(stage));
  lines[0].emplace_back("estimate");
  for (const PlanRow& row : rows) lines.push_back(plan_line(row));
  std::istringstream aligned(aligned_rows(lines));
  std::string text, line;
  for (std::size_t i = 0; std::getline(aligned, line); ++i) {
    const std::string why = i == 0 ? "why" : rows[i - 1].planned.stages.why();
    text += line + (why.empty() ? "" : "  " + why) + "\n";
  }
  return text;
}

std::string plan_text(const std::vector<PlanRow>& rows) {
  double left = 0;
  for (const PlanRow& row : rows) left += row.seconds;
  const auto todo = std::count_if(rows.begin(), rows.end(), [](const PlanRow& row) {
    return !row.planned.stages.done();
  });
  const std::string time = left > 0 ? "about " + format_duration(left) : "time unknown";
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
         {"estimated_seconds", row.seconds}}
    );
  return {{"cells", json}};
}

int run_plan(const CommonOptions& common) {
  const Profile profile = common.resolved_profile();
  const auto records = read_records(common.records_file(profile));
  const auto rows = plan_rows(planned_cells(common, profile, records), records);
  if (common.json)
    print_json(plan_json(rows));
  else
    print_text(plan_text(rows));
  return 0;
}

void add_plan_verb(CommandLine& line) {
  line.add_verb(
      line.app,
      "plan",
      "list the cells that `all` would run: which stages are done, and why the others are not",
      [&line] { return run_plan(line.common); }
  );
}

}  // namespace

GLINT_REGISTER(Verb, {"plan", add_plan_verb})

}  // namespace glint
