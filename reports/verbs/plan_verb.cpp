// SPDX-License-Identifier: MIT
#include <algorithm>

#include "glint/core/progress.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

struct PlanRow {
  PlanCell cell;
  CellState state = CellState::kPending;
  double seconds = 0;  // estimated; 0: unknown
};

std::vector<PlanRow> plan_rows(const CommonOptions& common) {
  const Profile profile = common.resolved_profile();
  const auto records = read_records(common.records_file(profile));
  std::vector<PlanRow> rows;
  for (const PlanCell& cell : make_plan(profile, common.filter(), common.set))
    rows.push_back(
        {cell, state_of(cell, records, scene_hash(cell.source)), estimated_seconds(cell, records)}
    );
  return rows;
}

std::string plan_text(const std::vector<PlanRow>& rows) {
  std::vector<std::vector<std::string>> lines{{"cell", "state", "estimate"}};
  double left = 0;
  for (const PlanRow& row : rows) {
    lines.push_back(
        {row.cell.cell.text(),
         std::string(state_name(row.state)),
         row.seconds > 0 ? format_duration(row.seconds) : "unknown"}
    );
    if (row.state != CellState::kDone) left += row.seconds;
  }
  const auto todo = std::count_if(rows.begin(), rows.end(), [](const PlanRow& row) {
    return row.state != CellState::kDone;
  });
  return aligned_rows(lines) + fmt::format(
                                   "{} of {} cells to run, {}\n",
                                   todo,
                                   rows.size(),
                                   left > 0 ? "about " + format_duration(left) : "time unknown"
                               );
}

Json plan_json(const std::vector<PlanRow>& rows) {
  Json json = Json::array();
  for (const PlanRow& row : rows)
    json.push_back(
        {{"scene", row.cell.cell.scene},
         {"method", row.cell.cell.method},
         {"seed", row.cell.cell.seed},
         {"state", state_name(row.state)},
         {"config_hash", row.cell.config_hash},
         {"estimated_seconds", row.seconds}}
    );
  return {{"cells", json}};
}

int run_plan(const CommonOptions& common) {
  const auto rows = plan_rows(common);
  if (common.json)
    print_json(plan_json(rows));
  else
    print_text(plan_text(rows));
  return 0;
}

void add_plan_verb(CommandLine& line) {
  line.add_verb(line.app, "plan", "list the cells that `all` would run", [&line] {
    return run_plan(line.common);
  });
}

}  // namespace

GLINT_REGISTER(Verb, {"plan", add_plan_verb})

}  // namespace glint
