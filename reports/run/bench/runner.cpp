// SPDX-License-Identifier: MIT
#include "reports/run/bench/runner.h"

#include "datasets/holdout.h"
#include "glint/core/file_lock.h"
#include "glint/core/interrupt.h"
#include "glint/core/left_behind.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "reports/run/bench/cell_run.h"
#include "reports/run/records/merge_runs.h"
#include "reports/run/records/run_folder.h"

namespace glint {

namespace {

// Runs the plan cell by cell, with one scene in memory at a time.
class Runner {
 public:
  explicit Runner(const RunnerOptions& options)
      : options_(options), records_file_(options.out / "records.jsonl") {}

  RunSummary run() {
    remove_left_behind(options_.out, false);
    remove_left_behind(options_.out / "tables");
    const auto plan = make_plan(options_.profile, options_.filter, options_.assignments);
    try {
      std::vector<const PlanCell*> taken;
      for (std::size_t i = 0; i < plan.size(); ++i)
        if (!try_one(fmt::format("[{}/{}] ", i + 1, plan.size()), plan[i]))
          taken.push_back(&plan[i]);
      for (const PlanCell* cell : taken)
        if (!try_one("again: ", *cell)) ++summary_.elsewhere;
    } catch (const Interrupted&) {
      summary_.interrupted = true;
    }
    return summary_;
  }

 private:
  bool has_failed_enough() const {
    return options_.max_failures > 0 && summary_.failed >= options_.max_failures;
  }

  // Others write, too.
  void read_new_records() {
    const std::uintmax_t bytes = is_file(records_file_) ? fs::file_size(records_file_) : 0;
    if (bytes > 0 && bytes == records_bytes_) return;
    records_ = read_records(records_file_);
    records_bytes_ = bytes;
  }

  // False: another process is at it.
  bool try_one(const std::string& place, const PlanCell& cell) {
    throw_if_interrupted();
    if (has_failed_enough()) {
      ++summary_.not_begun;
      return true;
    }
    if (!options_.announced) log::info(place + cell.cell.text());
    const auto lock = FileLock::take_from_orphan(
        FileLock::file_beside(run_folder(options_.out, cell.cell)),
        [](const std::string& holder) { log::info("  waiting until an orphan ends: " + holder); }
    );
    if (const auto* holder = std::get_if<std::string>(&lock)) {
      log::info("  left to " + *holder);
      return false;
    }
    read_new_records();
    run_one(cell);
    return true;
  }

  void run_one(const PlanCell& cell) {
    CellStages stages;
    try {
      stages = stages_of(cell);
      if (stages.done()) return reuse();
      load_scene_of(cell);
      // Data that were made just now may be what they were before.
      if (!stages[Stage::kData].done) stages = stages_of(cell);
      if (stages.done()) return reuse();
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception& error) {
      return finish(cell, record_without_data(cell, options_, error));
    }
    log::info("  " + stages.why());
    finish(cell, run_cell(cell, options_, loaded_, stages, records_));
  }

  CellStages stages_of(const PlanCell& cell) const {
    const fs::path run = options_.force ? fs::path() : run_folder(options_.out, cell.cell);
    return cell_stages(
        cell,
        options_.profile,
        options_.identify(cell.source),
        find_record(records_, cell.cell),
        run
    );
  }

  void reuse() {
    log::info("  finished earlier, reused (--force runs it again)");
    ++summary_.reused;
  }

  void load_scene_of(const PlanCell& cell) {
    if (loaded_name_ == cell.cell.scene) return;
    loaded_ = options_.load(cell.source);
    check_not_held_out(loaded_.folder, loaded_.scene);
    GLINT_CHECK(
        !loaded_.scene.test.empty() && !loaded_.scene.train.empty(),
        kBadReference,
        "{}: {} training and {} test views; both are needed",
        loaded_.folder.string(),
        loaded_.scene.train.size(),
        loaded_.scene.test.size()
    );
    loaded_name_ = cell.cell.scene;
  }

  void finish(const PlanCell& cell, const Record& record) {
    const fs::path run = run_folder(options_.out, record.cell);
    append_record(records_file_, record);
    if (record.ok()) write_file(run / kRecordFile, record_to_json(record).dump() + "\n");
    count(record);
    if (!options_.ended) return;
    options_.ended({record, run, [&]() -> const LoadedScene& {
                      load_scene_of(cell);
                      return loaded_;
                    }});
  }

  void count(const Record& record) {
    if (record.ok()) {
      ++summary_.ran;
      return;
    }
    ++summary_.failed;
    if (!options_.announced)
      log::warn(fmt::format(
          "{} failed in {}: {}", record.cell.text(), record.failure->stage, record.failure->message
      ));
  }

  const RunnerOptions& options_;
  fs::path records_file_;
  std::vector<Record> records_;
  std::uintmax_t records_bytes_ = 0;  // of the file when they were read
  LoadedScene loaded_;
  std::string loaded_name_;
  RunSummary summary_;
};

}  // namespace

RunSummary run_profile(const RunnerOptions& options) { return Runner(options).run(); }

}  // namespace glint
