// SPDX-License-Identifier: MIT
#include <memory>
#include <set>

#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "reports/executors/task_file.h"
#include "reports/verbs/run_options.h"

namespace glint {
namespace {

struct ChosenCells {
  std::string tasks;
  std::size_t task = 0;
  bool data_only = false;
};

// Makes what is not there yet.
void make_data(const fs::path& data_folder, RunnerOptions options) {
  install_interrupt_handler();
  leave_out_missing(data_folder, options);
  std::set<std::string> scenes;
  for (const PlanCell& cell : make_plan(options.profile, options.filter, options.assignments))
    if (scenes.insert(cell.cell.scene).second) options.load(cell.source);
}

int run_chosen(const CommonOptions& common, CellRunOptions how, const ChosenCells& chosen) {
  if (!chosen.tasks.empty()) how.cells = {cell_of_task(chosen.tasks, chosen.task)};
  RunnerOptions options = runner_options(common, how);
  // Whoever asks for one cell in this process knows which.
  options.announced = how.executor == "inline" && options.filter.cells.size() == 1;
  if (chosen.data_only) {
    make_data(common.data, options);
    return 0;
  }
  const RunSummary summary = run_cells(common, how, options);
  if (!options.announced) log::info(summary_text(summary));
  if (common.json) print_json(summary_json(summary));
  return exit_code_of(summary);
}

void add_run_verb(CommandLine& line) {
  auto how = std::make_shared<CellRunOptions>();
  auto chosen = std::make_shared<ChosenCells>();
  CLI::App* verb = line.add_verb(
      line.app,
      "run",
      "run cells of a profile, without tables: what `all` and clusters start",
      [&line, how, chosen] { return run_chosen(line.common, *how, *chosen); },
      kAllOptions | kDeviceLater
  );
  add_cell_run_options(*verb, *how);
  verb->add_option("--tasks", chosen->tasks, "file of cells, one a line (`plan --tasks`)");
  verb->add_option("--task", chosen->task, "which line of --tasks; the first is 0");
  verb->add_flag("--data-only", chosen->data_only, "make the data of the cells, no more");
}

}  // namespace

GLINT_REGISTER(Verb, {"run", add_run_verb})

}  // namespace glint
