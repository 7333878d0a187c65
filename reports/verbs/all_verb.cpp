// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/progress.h"
#include "reports/figures/figures.h"
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

int run_all(const CommonOptions& common, const CellRunOptions& how) {
  const RunSummary summary = run_cells(common, how, runner_options(common, how));
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

GLINT_REGISTER(Verb, {"all", add_all_verb})

}  // namespace glint
