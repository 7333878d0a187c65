// SPDX-License-Identifier: MIT
#include <memory>
#include <set>

#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "reports/show/figures/figures.h"
#include "reports/verbs/report_verb.h"
#include "reports/verbs/result_tables.h"
#include "reports/verbs/run_options.h"

namespace glint {

namespace {

void print_summary_json(
    const RunSummary& summary,
    const fs::path& folder,
    const fs::path& page,
    const std::vector<Table>& tables
) {
  Json json = summary_json(summary);
  json["folder"] = folder.string();
  json["page"] = page.string();
  json["tables"] = Json::array();
  for (const Table& table : tables) json["tables"].push_back(table_json(table));
  print_json(json);
}

// A cluster has the cells; its last job makes the tables.
int handed_over(const CommonOptions& common, const fs::path& folder, const RunSummary& summary) {
  Json json = summary_json(summary);
  json["folder"] = folder.string();
  if (common.json) print_json(json);
  log::info(fmt::format(
      "{} cells submitted, {} done before; `status` shows how far they are, tables will be in {}",
      summary.submitted,
      summary.reused,
      (folder / "tables").string()
  ));
  return 0;
}

// Makes what is not there yet.
int make_data(const fs::path& data_folder, RunnerOptions options) {
  install_interrupt_handler();
  leave_out_missing(data_folder, options);
  std::set<std::string> scenes;
  for (const PlanCell& cell : make_plan(options.profile, options.filter, options.assignments))
    if (scenes.insert(cell.cell.scene).second) options.load(cell.source);
  return 0;
}

int run_without_tables(
    const CommonOptions& common, const CellRunOptions& how, RunnerOptions& options
) {
  // Whoever asks for one cell in this process knows which.
  options.announced = how.executor == "inline" && options.filter.cells.size() == 1;
  const RunSummary summary = run_cells(common, how, options);
  if (!options.announced) log::info(summary_text(summary));
  if (common.json) print_json(summary_json(summary));
  return exit_code_of(summary);
}

void add_all_verb(CommandLine& line) {
  auto how = std::make_shared<CellRunOptions>();
  CLI::App* verb = line.add_verb(
      line.app,
      "all",
      "run every cell of a profile, print the tables and write the report",
      [&line, how] { return run_all(line.common, *how); },
      kAllOptions | kDeviceLater
  );
  add_cell_run_options(*verb, *how);
}

}  // namespace

int run_all(const CommonOptions& common, const CellRunOptions& how) {
  RunnerOptions options = runner_options(common, how);
  if (how.data_only) return make_data(common.data, options);
  if (how.no_tables) return run_without_tables(common, how, options);
  const RunSummary summary = run_cells(common, how, options);
  const fs::path folder = common.own_folder(common.resolved_profile());
  if (summary.submitted > 0) return handed_over(common, folder, summary);
  const auto tables = result_tables(folder);
  write_tables(folder, tables);
  if (write_figures.here()) write_figures({folder, load_run_data});
  const fs::path page = write_report(common, folder, tables);
  if (common.json)
    print_summary_json(summary, folder, page, tables);
  else
    print_tables(tables);
  log::info(fmt::format(
      "{}; tables in {}, page {}",
      summary_text(summary),
      (folder / "tables").string(),
      page.string()
  ));
  return exit_code_of(summary);
}

GLINT_REGISTER(Verb, {"all", add_all_verb})

}  // namespace glint
