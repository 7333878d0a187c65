// SPDX-License-Identifier: MIT
#include "reports/run/bench/cell_run.h"

#include <chrono>

#include "glint/core/device_lost.h"
#include "glint/core/interrupt.h"
#include "glint/core/machine.h"
#include "reports/run/bench/cell_needs.h"
#include "reports/run/bench/mesh_stage.h"
#include "reports/run/bench/run_record.h"
#include "reports/run/records/failure_kinds.h"

namespace glint {

namespace {

using Clock = std::chrono::steady_clock;

// Which stage runs, how long each took: for records.
class StageClock {
 public:
  explicit StageClock(Json& timings) : timings_(timings) {}
  void enter(const std::string& stage) {
    leave();
    stage_ = stage;
    start_ = Clock::now();
  }
  void leave() {
    if (!stage_.empty())
      timings_[stage_] = std::chrono::duration<double>(Clock::now() - start_).count();
  }
  const std::string& stage() const { return stage_; }

 private:
  Json& timings_;
  std::string stage_;
  Clock::time_point start_;
};

RunSpec spec_of(
    const PlanCell& cell,
    const RunnerOptions& options,
    const LoadedScene& loaded,
    const CellStages& stages
) {
  RunSpec spec = make_spec(cell, options.profile, loaded, run_folder(options.out, cell.cell));
  spec.train_document = stages[Stage::kTrain].document;
  spec.checkpoint_seconds = options.checkpoint_seconds;
  spec.anew = options.force;
  return spec;
}

Record record_of(const PlanCell& cell, const RunnerOptions& options) {
  return new_record(options.profile.name, cell.source.dataset, cell.cell);
}

Failure failure_of(const std::exception& error, const std::string& stage, const fs::path& run) {
  return {
      stage,
      std::string(failure_kind(error, stage)),
      error.what(),
      log_tail(run),
      run.empty() ? -1 : last_iteration(run)};
}

class CellRun {
 public:
  CellRun(
      const PlanCell& cell,
      const RunnerOptions& options,
      const LoadedScene& loaded,
      const CellStages& stages
  )
      : profile_(options.profile),
        scene_(loaded.scene),
        stages_(stages),
        spec_(spec_of(cell, options, loaded, stages)),
        record_(record_of(cell, options)),
        clock_(record_.timings) {
    record_.dataset_hash = scene_.spec_hash;
    record_.train_key = stages[Stage::kTrain].key();
    record_.score_key = stages[Stage::kScore].key();
  }

  Record run(const std::vector<Record>& records) {
    const Record* earlier = find_record(records, record_.cell);
    if (earlier && earlier->ok()) keep_timings(*earlier);
    try {
      enter(Stage::kTrain);
      if (!stages_[Stage::kTrain].done) check_memory(records);
      run_stages();
    } catch (const Interrupted&) {
      throw;
    } catch (const DeviceLost&) {
      throw;  // no other cell could run
    } catch (const std::exception& error) {
      record_.metrics.clear();
      record_.failure = failure_of(error, clock_.stage(), spec_.folder);
    }
    record_.process_memory_mb = peak_memory_mb();
    return std::move(record_);
  }

 private:
  // What a stage took counts for as long as its files do.
  void keep_timings(const Record& earlier) {
    for (const Stage stage : kStages)
      if (const std::string name(stage_name(stage)); stages_[stage].done)
        if (const auto found = earlier.timings.find(name); found != earlier.timings.end())
          record_.timings[name] = *found;
  }

  void check_memory(const std::vector<Record>& records) {
    const Estimate estimate = estimate_memory(
        memory_user(spec_.method, spec_.config, profile_), size_of(scene_), records
    );
    record_.estimated_memory_mb = estimate.bytes / 1e6;
    check_fits(estimate, available_memory_bytes() + resident_memory_bytes());
  }

  void run_stages() {
    method_ = stages_[Stage::kTrain].done ? load_trained(spec_) : train_stage(spec_, scene_);
    run(Stage::kRender, [&] { render_stage(spec_, scene_, *method_); });
    run(Stage::kMesh, [&] { try_mesh_stage(spec_, scene_, *method_, profile_.tsdf_options()); });
    enter(Stage::kScore);
    score();
    clock_.leave();
  }

  template <class Work>
  void run(Stage stage, const Work& work) {
    if (stages_[stage].done) return;
    enter(stage);
    work();
    clock_.leave();
  }
  void enter(Stage stage) { clock_.enter(std::string(stage_name(stage))); }

  void score() {
    const TimingOptions timing{profile_.timing_frames, profile_.timing_warmup};
    ScoreOptions options{
        .mesh = profile_.mesh_protocol(),
        .cost = training_cost(spec_),
        .timing = timing,
        .truth = stages_[Stage::kScore].document.value("truth", "")};
    options.cost["fps"] = measure_fps(*method_, scene_, timing);
    options.cost["num-surfels"] = static_cast<double>(method_->num_surfels());
    const Scores means = eval_stage(spec_, scene_, options);
    Record scored = make_record(profile_.name, spec_, scene_, means);
    record_.timings.erase("train");  // of a training that was only loaded
    record_.timings.update(scored.timings);
    scored.timings = std::move(record_.timings);
    scored.estimated_memory_mb = record_.estimated_memory_mb;
    record_ = std::move(scored);
  }

  const Profile& profile_;
  const Scene& scene_;
  const CellStages& stages_;
  RunSpec spec_;
  Record record_;
  StageClock clock_;
  std::unique_ptr<Method> method_;
};

}  // namespace

Record run_cell(
    const PlanCell& cell,
    const RunnerOptions& options,
    const LoadedScene& loaded,
    const CellStages& stages,
    const std::vector<Record>& records
) {
  return CellRun(cell, options, loaded, stages).run(records);
}

Record record_without_data(
    const PlanCell& cell, const RunnerOptions& options, const std::exception& error
) {
  return failed_record(cell, options, failure_of(error, "data", {}));
}

Record failed_record(const PlanCell& cell, const RunnerOptions& options, Failure failure) {
  Record record = record_of(cell, options);
  record.failure = std::move(failure);
  return record;
}

}  // namespace glint
