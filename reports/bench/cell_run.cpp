// SPDX-License-Identifier: MIT
#include "reports/bench/cell_run.h"

#include <chrono>

#include "glint/core/device_lost.h"
#include "glint/core/interrupt.h"
#include "glint/core/machine.h"
#include "reports/bench/memory_estimate.h"
#include "reports/bench/mesh_stage.h"
#include "reports/bench/run_record.h"
#include "reports/bench/run_stage.h"
#include "reports/bench/stage_documents.h"
#include "reports/bench/stages.h"
#include "reports/records/environment.h"
#include "reports/records/failure_kinds.h"

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
  RunSpec spec;
  spec.folder = run_folder(options.out, cell.cell);
  spec.method = cell.cell.method;
  spec.config = cell.config;
  spec.options.iterations = options.profile.iterations;
  spec.options.seed = cell.cell.seed;
  spec.dataset_folder = loaded.folder;
  spec.dataset = cell.source.dataset;
  spec.scene = cell.cell.scene;
  spec.max_pixels = cell.source.max_pixels;
  spec.image_ratio = cell.source.image_ratio;
  spec.dataset_hash = loaded.scene.spec_hash;
  spec.train_document = stages[Stage::kTrain].document;
  spec.checkpoint_seconds = options.checkpoint_seconds;
  spec.test_psnr_every = options.profile.test_psnr_every;
  spec.anew = options.force;
  return spec;
}

Record record_of(const PlanCell& cell, const RunnerOptions& options) {
  Record record;
  record.profile = options.profile.name;
  record.dataset = cell.source.dataset;
  record.cell = cell.cell;
  record.environment = environment_json();
  return record;
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
    const MemoryEstimate estimate = estimate_memory(
        memory_user(spec_.method, spec_.config, profile_), size_of(scene_), records
    );
    record_.estimated_memory_mb = estimate.bytes / 1e6;
    check_fits(estimate, available_memory_bytes() + resident_memory_bytes());
  }

  void run_stages() {
    method_ = stages_[Stage::kTrain].done ? load_trained(spec_) : train_stage(spec_, scene_);
    run(Stage::kRender, [&] {
      render_stage(spec_, scene_, *method_);
      return std::string();
    });
    run(Stage::kMesh, [&] { return make_meshes(); });
    enter(Stage::kScore);
    run_stage(spec_.folder, Stage::kScore, stages_[Stage::kScore].document, [&] {
      score();
      return std::string();
    });
    clock_.leave();
  }

  void run(Stage stage, const std::function<std::string()>& work) {
    if (stages_[stage].done) return;
    enter(stage);
    begin_stage(spec_.folder, stage);
    const std::string note = work();
    end_stage(spec_.folder, stage, stages_[stage].document, note);
    clock_.leave();
  }
  void enter(Stage stage) { clock_.enter(std::string(stage_name(stage))); }

  // Without a mesh, the stage and the scores behind it also go by the memory that was allowed.
  std::string make_meshes() {
    const TsdfOptions options = profile_.tsdf_options();
    std::string why = try_mesh_stage(spec_, scene_, *method_, options);
    if (why.empty()) return why;
    Json& document = stages_[Stage::kMesh].document;
    document = document_without_mesh(document, options);
    stages_[Stage::kScore].document["inputs"]["mesh"] = stage_key(document);
    record_.score_key = stages_[Stage::kScore].key();
    return why;
  }

  void score() {
    const TimingOptions timing{profile_.timing_frames, profile_.timing_warmup};
    Scores cost = training_cost(spec_);
    cost["fps"] = measure_fps(*method_, scene_, timing);
    cost["num-surfels"] = static_cast<double>(method_->num_surfels());
    record_.metrics = eval_stage(spec_, scene_, cost, profile_.mesh_protocol(), timing);
    describe_run(record_, spec_, scene_);
  }

  const Profile& profile_;
  const Scene& scene_;
  CellStages stages_;
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
