// SPDX-License-Identifier: MIT
// Cells as array jobs of Slurm: data that have to be made first, then the cells, the longest in
// front, and a job for the tables when all have ended. A task that is told to stop writes a
// checkpoint and goes back into the queue.
#include <algorithm>
#include <charconv>

#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "reports/run/bench/child_process.h"
#include "reports/run/bench/device_of_cells.h"
#include "reports/run/executors/executor.h"
#include "reports/run/executors/slurm_jobs.h"
#include "reports/run/executors/task_file.h"

namespace glint {
namespace {

constexpr std::size_t kUsualArray = 1001;  // Slurm's own MaxArraySize
constexpr int kSecondsToStop = 120;        // between the signal and the end of the time

// Of the task: OFFSET, then the words of its program, to which it adds which task it is.
constexpr const char* kTaskScript = R"(#!/bin/bash
# Runs one task of an array: task.sh OFFSET PROGRAM WORDS...
# When its time is nearly over (SIGUSR1), the program writes a checkpoint and the task goes back into the queue.
set -u
task=$(($1 + SLURM_ARRAY_TASK_ID))
shift
words=("$@")
# What --force had to undo is undone since the first time.
if [ "${SLURM_RESTART_COUNT:-0}" -gt 0 ]; then
  for i in "${!words[@]}"; do [ "${words[i]}" != --force ] || unset "words[i]"; done
fi
"${words[@]}" --task "$task" &
child=$!
trap 'kill -USR1 "$child" 2>/dev/null' USR1
trap 'kill -TERM "$child" 2>/dev/null' TERM
while :; do
  wait "$child"
  code=$?
  [ "$code" -gt 128 ] && kill -0 "$child" 2>/dev/null || break
done
# After SIGTERM it is for Slurm to know: it may have been cancelled.
[ "$code" -ne 138 ] || scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
exit "$code"
)";

constexpr const char* kTableScript = R"(#!/bin/bash
# When all cells have ended, finished or not: table.sh PROGRAM WORDS...
set -u
program=$1
shift
"$program" table "$@" && "$program" report "$@"
)";

using Words = ChildProcess::Words;

[[noreturn]] void fail(const Words& words, const std::string& output) {
  throw Error(
      ExitCode::kEnvironment,
      fmt::format(
          "{}: {}", words.at(0), output.empty() ? "no such program; is this a cluster?" : output
      )
  );
}

std::string output_of(const Words& words) {
  const auto result = run_command(words);
  if (!result) fail(words, "");
  if (!result->end.good()) fail(words, result->output);
  return result->output;
}

// Tasks that one array may have.
std::size_t max_array_size() {
  const std::string config = output_of({"scontrol", "show", "config"});
  const std::size_t field = config.find("MaxArraySize");
  const std::size_t digits = config.find_first_of("0123456789", field);
  std::size_t size = 0;
  if (field != std::string::npos && digits != std::string::npos)
    std::from_chars(config.data() + digits, config.data() + config.size(), size);
  return size == 0 ? kUsualArray : size;
}

class Submission {
 public:
  Submission(const RunnerOptions& options, const ExecutorOptions& how)
      : options_(options),
        how_(how),
        plan_(make_plan(options.profile, options.filter, options.assignments)),
        device_(how.on_gpu ? Device::kCuda : current_device()),
        queue_(plan_, options, how.order.value_or(CellOrder::kLongest)),
        folder_(fs::absolute(slurm_folder(options.out))),
        program_(fs::read_symlink(kThisProgram)) {}

  RunSummary run() {
    RunSummary summary;
    summary.reused = queue_.num_done();
    if (queue_.empty()) return summary;
    array_ = max_array_size();
    number_ = 1;
    while (is_taken(file("tasks", "tsv"))) ++number_;
    write_file(file("task", "sh"), kTaskScript);
    write_file(file("table", "sh"), kTableScript);
    const auto cells = queue_.cells();
    const std::string data = submit_data();
    const std::string done = submit_tasks("cells", "tasks", cells, data, {});
    submit_tables(done);
    summary.submitted = static_cast<int>(cells.size());
    return summary;
  }

 private:
  fs::path file(const std::string& name, const std::string& extension) const {
    return folder_ / fmt::format("{}-{}.{}", name, number_, extension);
  }

  // Empty: all data are there.
  std::string submit_data() {
    std::vector<const PlanCell*> first_of_scene;
    std::string last;
    for (const PlanCell& cell : plan_) {
      if (cell.cell.scene == last || !cell.source.made()) continue;
      last = cell.cell.scene;
      if (!options_.identify(cell.source).why_not.empty()) first_of_scene.push_back(&cell);
    }
    if (first_of_scene.empty()) return "";
    return submit_tasks("data", "data", first_of_scene, "", {"--data-only"});
  }

  // In as many arrays as Slurm wants; their ids, as dependencies name them.
  std::string submit_tasks(
      const std::string& stage,
      const std::string& list,
      const std::vector<const PlanCell*>& cells,
      const std::string& after,
      const Words& more
  ) {
    const fs::path tasks = file(list, "tsv");
    write_task_file(tasks, cells, queue_);
    std::string ids;
    for (std::size_t offset = 0; offset < cells.size(); offset += array_) {
      const std::size_t count = std::min(array_, cells.size() - offset);
      Words words = options_of(stage, after);
      words.push_back(fmt::format(
          "--array=0-{}{}", count - 1, how_.jobs > 1 ? fmt::format("%{}", how_.jobs) : ""
      ));
      append(
          words, {file("task", "sh").string(), std::to_string(offset), program_.string(), "all"}
      );
      append(words, {"--no-tables", "--executor", "local", "--tasks", tasks.string()});
      append(words, how_.profile_words);
      append(words, how_.run_words);
      append(words, more);
      const std::string id = submit(words);
      append_job(options_.out, {id, stage, tasks.string(), offset, count});
      ids += ":" + id;
    }
    log::info(fmt::format("{}: {} tasks, job{}", stage, cells.size(), ids));
    return ids;
  }

  void submit_tables(const std::string& after) {
    Words words = options_of("tables", after);
    append(words, {file("table", "sh").string(), program_.string()});
    append(words, how_.profile_words);
    const std::string id = submit(words);
    append_job(options_.out, {id, "tables", "", 0, 1});
    log::info(fmt::format("tables: job {}", id));
  }

  Words options_of(const std::string& stage, const std::string& after) const {
    Words words = {
        "sbatch",
        "--parsable",
        "--requeue",
        "--open-mode=append",
        fmt::format("--job-name=glint-{}-{}", options_.profile.name, stage),
        fmt::format("--chdir={}", fs::current_path().string()),
        fmt::format(
            "--output={}",
            (folder_ / (stage + (stage == "tables" ? "-%j.log" : "-%A_%a.log"))).string()
        )};
    if (!after.empty())
      append(words, {"--kill-on-invalid-dep=yes", "--dependency=afterany" + after});
    if (stage == "cells") append(words, cell_options());
    append(words, how_.sbatch);
    return words;
  }

  Words cell_options() const {
    Words words = {fmt::format("--signal=B:USR1@{}", kSecondsToStop)};
    if (options_.profile.gpus > 0 || how_.on_gpu)
      words.push_back(fmt::format("--gres=gpu:{}", std::max(1, options_.profile.gpus)));
    double most = 0;
    for (const PlanCell& cell : plan_) most = std::max(most, queue_.bytes_of(cell));
    constexpr double kReserve = 1.5;  // above what such cells took before
    if (most > 0) words.push_back(fmt::format("--mem={:.0f}M", most * kReserve / (1 << 20)));
    return words;
  }

  // sbatch's "1234" or "1234;cluster".
  static std::string submit(const Words& words) {
    const std::string output = output_of(words);
    const std::string id = output.substr(0, output.find_first_not_of("0123456789"));
    if (id.empty()) fail(words, "no job number in its answer: " + output);
    return id;
  }

  static void append(Words& words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
  }

  const RunnerOptions& options_;
  const ExecutorOptions& how_;
  std::vector<PlanCell> plan_;
  DeviceOfCells device_;
  CellQueue queue_;
  fs::path folder_, program_;
  std::size_t array_ = kUsualArray;
  int number_ = 1;
};

RunSummary run_slurm(const RunnerOptions& options, const ExecutorOptions& how) {
  GLINT_CHECK(
      how.time_for_all == 0,
      kUsage,
      "--executor slurm: --for is of cells that this command waits for; take --time-limit"
  );
  return Submission(options, how).run();
}

}  // namespace

GLINT_REGISTER(Executor, {"slurm", "jobs of a Slurm cluster, then the tables", run_slurm})

}  // namespace glint
