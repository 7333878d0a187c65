// SPDX-License-Identifier: MIT
#include "reports/verbs/run_options.h"

#include <cstdlib>
#include <map>
#include <set>

#include "glint/core/interrupt.h"
#include "glint/core/nearest.h"
#include "glint/core/parallel.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "metrics/tools/numeric_options.h"
#include "reports/run/bench/child_process.h"
#include "reports/run/executors/task_file.h"
#include "reports/run/parcels/make_parcel.h"
#include "reports/run/records/build_info.h"
#include "reports/run/records/environment.h"
#include "reports/run/records/manifest.h"

namespace glint {
namespace {

using Words = std::vector<std::string>;

// Which profile, where its results and data lie, and how its cells are trained.
Words profile_words(const CommonOptions& common) {
  Words words = {"--profile", common.profile, "--out", common.out};
  if (common.quiet) words.emplace_back("--quiet");
  return words;
}

Words run_words(const CommonOptions& common, const std::string& device) {
  Words words = {
      "--data",
      common.data,
      "--device",
      device,
      "--checkpoint-seconds",
      fmt::format("{}", common.checkpoint_seconds)};
  const auto add = [&](const char* option, const std::string& value) {
    words.insert(words.end(), {option, value});
  };
  if (common.iterations > 0) add("--iterations", std::to_string(common.iterations));
  if (common.test_psnr_every) add("--test-psnr-every", std::to_string(*common.test_psnr_every));
  for (const std::string& assignment : common.set) add("--set", assignment);
  return words;
}

// One cell in this process's place.
Words words_of_cell(
    const CommonOptions& common,
    const CellRunOptions& how,
    const CellKey& cell,
    bool force,
    const ProcessShare& share
) {
  Words words = {kThisProgram, "all", "--no-tables", "--executor", "inline"};
  for (const Words& more :
       {profile_words(common),
        run_words(common, share.gpu ? "cuda" : common.device),
        Words{"--cell", cell.text(), "--methods", cell.method},
        Words{"--seed", std::to_string(cell.seed), "--threads", std::to_string(share.threads)}})
    words.insert(words.end(), more.begin(), more.end());
  if (!how.parcels.empty()) words.insert(words.end(), {"--parcels", how.parcels});
  if (force) words.emplace_back("--force");
  if (!common.quiet && how.jobs > 1) words.emplace_back("--quiet");
  return words;
}

// What an engine elsewhere has to be told beside the profile, so that it plans the same cells.
Words words_of_choice(const CommonOptions& common, const CellRunOptions& how) {
  Words words = run_words(common, common.device);
  for (const std::string& method : common.methods) words.insert(words.end(), {"--methods", method});
  if (common.seed) words.insert(words.end(), {"--seed", std::to_string(*common.seed)});
  if (common.threads > 0) words.insert(words.end(), {"--threads", std::to_string(common.threads)});
  if (!how.time_limit.empty()) words.insert(words.end(), {"--time-limit", how.time_limit});
  if (!how.parcels.empty()) words.insert(words.end(), {"--parcels", how.parcels});
  if (how.force) words.emplace_back("--force");
  return words;
}

std::optional<CellOrder> order_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  GLINT_CHECK(
      text == "longest" || text == "given", kUsage, "--order {}: expected longest or given", text
  );
  return text == "given" ? CellOrder::kGiven : CellOrder::kLongest;
}

ExecutorOptions executor_options(const CommonOptions& common, const CellRunOptions& how) {
  ExecutorOptions options;
  options.jobs = how.jobs;
  options.time_limit = parse_duration("--time-limit", how.time_limit);
  options.time_for_all = parse_duration("--for", how.time_for_all);
  options.max_failures = how.max_failures;
  options.order = order_of(how.order);
  options.threads = num_threads();
  options.command = [common, how](const CellKey& cell, bool force, const ProcessShare& share) {
    return words_of_cell(common, how, cell, force, share);
  };
  if (common.device == "cuda" || (common.device == "auto" && !build_info().cuda.empty()))
    options.look_at_card = {
        kThisProgram, "doctor", "--card", "--device", common.device, "--json", "--quiet"};
  options.profile_words = profile_words(common);
  options.run_words = words_of_choice(common, how);
  options.sbatch = how.sbatch;
  options.on_gpu = common.device == "cuda";
  return options;
}

// All cells of the profile, and those of methods that are asked for beyond it.
std::set<std::string> cells_there_are(const RunnerOptions& options) {
  std::set<std::string> cells;
  for (const auto& methods : {std::vector<std::string>(), options.filter.methods})
    for (const PlanCell& cell : make_plan(options.profile, {.methods = methods}, {}))
      cells.insert(cell.cell.text());
  return cells;
}

// A misspelt one of several would be left out without a word.
void check_cells(const RunnerOptions& options) {
  if (options.filter.cells.empty()) return;
  const std::set<std::string> known = cells_there_are(options);
  for (const std::string& cell : options.filter.cells)
    GLINT_CHECK(
        known.contains(cell),
        kUsage,
        "cell {}: profile {} has none of that name; {}`status` lists them; a method that the "
        "profile "
        "does not name is run by --methods",
        cell,
        options.profile.name,
        did_you_mean(cell, {known.begin(), known.end()})
    );
}

}  // namespace

RunnerOptions runner_options(const CommonOptions& common, const CellRunOptions& how) {
  RunnerOptions options;
  options.profile = common.resolved_profile();
  options.filter = common.filter();
  options.assignments = common.set;
  options.out = common.own_folder(options.profile);
  options.force = how.force;
  options.checkpoint_seconds = common.checkpoint_seconds;
  options.identify = common.scene_identifier();
  options.load = common.scene_loader();
  if (!how.parcels.empty()) options.ended = parcel_writer(how.parcels);
  options.filter.cells = how.cells;
  if (!how.cells_file.empty())
    for (const std::string& cell : cells_of_tasks(how.cells_file))
      if (!cell.empty()) options.filter.cells.push_back(cell);
  if (!how.tasks.empty()) options.filter.cells = {cell_of_task(how.tasks, how.task)};
  check_cells(options);
  return options;
}

void add_cell_run_options(CLI::App& verb, CellRunOptions& options) {
  verb.add_flag("--force", options.force, "run finished cells again, training included");
  std::string executors = "how cells are run:";
  for (const auto& [id, executor] : Registry<Executor>::all())
    executors += fmt::format(" {} ({});", id, executor.title);
  executors.pop_back();
  verb.add_option("--executor", options.executor, executors)->capture_default_str();
  verb.add_option("--cell", options.cells, "only this scene/method/seed; may be given again");
  verb.add_option("--cells", options.cells_file, "only those of a file, one a line");
  verb.add_option("--tasks", options.tasks, "file of cells, one a line (`status --tasks`)");
  verb.add_option("--task", options.task, "which line of --tasks alone; the first is 0");
  verb.add_flag("--data-only", options.data_only, "make the data of the cells, no more");
  verb.add_flag("--no-tables", options.no_tables, "neither tables nor figures and page");
  const char* order =
      "longest or given (by --cell and --cells, else the profile); else longest where --jobs > 1";
  verb.add_option("--order", options.order, order);
  verb.add_option("--jobs", options.jobs, "cells at a time; they share --threads")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  const char* time_limit = "of a cell: 90s, 30m, 4h; its checkpoint stays";
  const auto is_given = [](const std::string& text) {
    return text.empty() ? "expected a time as 90s, 30m, 4h or 2d" : "";
  };
  verb.add_option("--time-limit", options.time_limit, time_limit)->check(is_given);
  const char* time_for_all =
      "of all cells: none begins that would not end in it, those that run then stop with "
      "checkpoints";
  verb.add_option("--for", options.time_for_all, time_for_all)->check(is_given);
  const char* failures = "no cell begins after so many have failed; 0: any number";
  verb.add_option("--max-failures", options.max_failures, failures)->check(at_least_zero());
  const char* parcels =
      "folder for a small file of each cell that ended, which `merge` takes over at home";
  verb.add_option("--parcels", options.parcels, parcels);
  verb.add_option("--sbatch", options.sbatch, "option for sbatch, as --sbatch=--partition=gpu");
}

int leave_out_missing(const fs::path& data_folder, RunnerOptions& options) {
  std::map<std::string, bool> missing;  // by scene
  std::set<std::string> manifests;
  int count = 0;
  const auto plan = make_plan(options.profile, options.filter, options.assignments);
  for (const PlanCell& cell : plan) {
    const Manifest* manifest = find_manifest(cell.source.manifest);
    if (manifest == nullptr) continue;
    const auto [known, is_new] = missing.try_emplace(cell.cell.scene, false);
    if (is_new) {
      const ManifestScene scene{cell.source.scene, cell.source.folder};
      known->second = !is_there(manifest_scene_folder(*manifest, scene, data_folder));
    }
    if (!known->second) continue;
    ++count;
    manifests.insert(manifest->id);
  }
  std::string text;
  for (const std::string& id : manifests) {
    const std::string of_manifest = missing_scenes_text(*find_manifest(id), data_folder);
    text += (text.empty() ? "" : "\n") + of_manifest;
    log::warn(of_manifest);
  }
  GLINT_CHECK(
      static_cast<std::size_t>(count) < plan.size(), kBadReference, "no cell has data\n{}", text
  );
  for (const auto& [scene, is_missing] : missing)
    if (is_missing) options.filter.skip.push_back(scene + "/*");
  return count;
}

RunSummary run_cells(
    const CommonOptions& common, const CellRunOptions& how, const RunnerOptions& options
) {
  install_interrupt_handler();
  RunnerOptions runnable = options;
  const ExecutorOptions executor = executor_options(common, how);
  check_device_name(common.device);
  const int without_data = leave_out_missing(common.data, runnable);
  // Jobs of a cluster may have a GPU where this machine has none.
  const bool by_others = how.executor == "local" || (executor.on_gpu && how.executor != "inline");
  if (!by_others) choose_device(common.device);
  RunSummary summary = find_executor(how.executor).run(runnable, executor);
  summary.without_data = without_data;
  if (!how.parcels.empty() && !summary.interrupted && summary.submitted == 0)
    write_missing_parcels(runnable, how.parcels, !how.time_for_all.empty());
  return summary;
}

int exit_code_of(const RunSummary& summary) {
  if (summary.interrupted) return interrupted_exit();
  const bool partial = summary.failed > 0 || summary.elsewhere > 0 || summary.not_begun > 0 ||
                       summary.without_data > 0;
  return static_cast<int>(partial ? ExitCode::kPartial : ExitCode::kSuccess);
}

Json summary_json(const RunSummary& summary) {
  return {
      {"ran", summary.ran},
      {"reused", summary.reused},
      {"failed", summary.failed},
      {"elsewhere", summary.elsewhere},
      {"not_begun", summary.not_begun},
      {"without_data", summary.without_data},
      {"submitted", summary.submitted},
      {"interrupted", summary.interrupted}};
}

std::string summary_text(const RunSummary& summary) {
  std::string text =
      fmt::format("{} run, {} reused, {} failed", summary.ran, summary.reused, summary.failed);
  if (summary.without_data > 0) text += fmt::format(", {} without data", summary.without_data);
  if (summary.not_begun > 0) text += fmt::format(", {} not begun", summary.not_begun);
  if (summary.elsewhere > 0) text += fmt::format(", {} left to other processes", summary.elsewhere);
  if (summary.interrupted) text += ", interrupted (the same command goes on)";
  return text;
}

double parse_duration(const std::string& option, const std::string& text) {
  if (text.empty()) return 0;
  static const std::map<std::string, double> kUnits = {
      {"", 1}, {"s", 1}, {"m", 60}, {"h", 3600}, {"d", 86400}};
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  const auto unit = kUnits.find(end);
  GLINT_CHECK(
      end != text.c_str() && unit != kUnits.end() && number > 0 && number < 1e7,
      kUsage,
      "{} {}: expected a time as 90s, 30m, 4h or 2d",
      option,
      text
  );
  return number * unit->second;
}

}  // namespace glint
