// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "reports/bench/runner.h"
#include "reports/figures/figures.h"
#include "reports/verbs/report_verb.h"
#include "reports/verbs/result_tables.h"

namespace glint {

namespace {

int exit_code_of(const RunSummary& summary) {
  if (summary.interrupted) return interrupted_exit();
  const bool partial = summary.failed > 0 || summary.elsewhere > 0;
  return static_cast<int>(partial ? ExitCode::kPartial : ExitCode::kSuccess);
}

void print_summary_json(
    const RunSummary& summary,
    const fs::path& folder,
    const fs::path& page,
    const std::vector<Table>& tables
) {
  Json json = {
      {"folder", folder.string()},
      {"page", page.string()},
      {"ran", summary.ran},
      {"reused", summary.reused},
      {"failed", summary.failed},
      {"elsewhere", summary.elsewhere},
      {"interrupted", summary.interrupted}};
  json["tables"] = Json::array();
  for (const Table& table : tables) json["tables"].push_back(table_json(table));
  print_json(json);
}

int run_all(const CommonOptions& common, bool force) {
  install_interrupt_handler();
  RunnerOptions options;
  options.profile = common.resolved_profile();
  options.filter = common.filter();
  options.assignments = common.set;
  options.out = common.own_folder(options.profile);
  options.force = force;
  options.checkpoint_seconds = common.checkpoint_seconds;
  options.identify = common.scene_identifier();
  options.load = common.scene_loader();
  const RunSummary summary = run_profile(options);
  const auto tables = result_tables(options.out);
  write_tables(options.out, tables);
  if (write_figures.here()) write_figures({options.out, load_run_data});
  const fs::path page = write_report(common, options.out, tables);
  if (common.json)
    print_summary_json(summary, options.out, page, tables);
  else
    print_tables(tables);
  log::info(fmt::format(
      "{} run, {} reused, {} failed{}{}; tables in {}, page {}",
      summary.ran,
      summary.reused,
      summary.failed,
      summary.elsewhere > 0 ? fmt::format(", {} left to other processes", summary.elsewhere) : "",
      summary.interrupted ? ", interrupted (the same command goes on)" : "",
      (options.out / "tables").string(),
      page.string()
  ));
  return exit_code_of(summary);
}

void add_all_verb(CommandLine& line) {
  auto force = std::make_shared<bool>(false);
  CLI::App* verb = line.add_verb(
      line.app,
      "all",
      "run every cell of a profile, print the tables and write the report",
      [&line, force] { return run_all(line.common, *force); }
  );
  verb->add_flag("--force", *force, "run finished cells again, training included");
}

}  // namespace

GLINT_REGISTER(Verb, {"all", add_all_verb})

}  // namespace glint
