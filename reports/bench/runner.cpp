// SPDX-License-Identifier: MIT
#include "reports/bench/runner.h"

#include <chrono>
#include <new>
#include <optional>

#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "metrics/fusion/tsdf_volume.h"
#include "metrics/metric.h"
#include "reports/bench/evaluate.h"
#include "reports/bench/mesh_stage.h"
#include "reports/records/environment.h"

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

RunSpec spec_of(const PlanCell& cell, const RunnerOptions& options, const LoadedScene& loaded) {
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
  spec.config_hash = cell.config_hash;
  spec.dataset_hash = loaded.scene.spec_hash;
  return spec;
}

Record record_of(const PlanCell& cell, const RunnerOptions& options) {
  Record record;
  record.profile = options.profile.name;
  record.dataset = cell.source.dataset;
  record.cell = cell.cell;
  record.config_hash = cell.config_hash;
  record.dataset_hash = scene_hash(cell.source);
  record.environment = environment_json();
  return record;
}

std::unique_ptr<Method> trained_method(const RunSpec& spec, const Scene& scene, bool force) {
  if (!force && trained_cost(spec).has_value()) {
    log::info(spec.folder.string() + ": trained already, rendering and scoring");
    return load_trained(spec);
  }
  return train_stage(spec, scene);
}

void run_stages(
    const RunSpec& spec,
    const LoadedScene& loaded,
    const RunnerOptions& options,
    Record& record,
    StageClock& clock
) {
  clock.enter("train");
  const auto method = trained_method(spec, loaded.scene, options.force);
  clock.enter("eval");
  RunScores scores = render_and_score(spec, loaded.scene, *method, options.profile);
  record.metrics = std::move(scores.means);
  record.not_measured = std::move(scores.not_measured);
  record.not_applicable = std::move(scores.not_applicable);
  record.num_surfels = method->num_surfels();
  for (const std::string& warning : method->warnings()) record.warnings.push_back(warning);
  const Camera& camera = loaded.scene.test.front().camera;
  record.resolution = fmt::format("{}x{}", camera.width, camera.height);
  clock.leave();
  record.timings["train"] = trained_cost(spec)->seconds;
}

// With --rescore: the run in the folder as what it is, with the hash of the code that trained it.
void accept_earlier_training(RunSpec& spec, const RunnerOptions& options, Record& record) {
  if (!options.rescore || trained_cost(spec)) return;
  const auto earlier = trained_elsewhere(spec);
  if (!earlier) return;
  spec.config_hash = record.config_hash = earlier->config_hash;
  record.warnings.push_back("trained by revision " + earlier->revision);
}

Failure failure_of(const std::exception& error, const std::string& stage, const fs::path& run) {
  return {stage, failure_kind(error, stage), error.what(), log_tail(run)};
}

// One cell to its record. Interrupted passes through: an unfinished cell leaves no record.
Record run_cell(const PlanCell& cell, const RunnerOptions& options, const LoadedScene& loaded) {
  Record record = record_of(cell, options);
  record.dataset_hash = loaded.scene.spec_hash;
  StageClock clock(record.timings);
  RunSpec spec = spec_of(cell, options, loaded);
  accept_earlier_training(spec, options, record);
  try {
    run_stages(spec, loaded, options, record, clock);
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    record.metrics.clear();
    record.failure = failure_of(error, clock.stage(), spec.folder);
  }
  return record;
}

// Makes the meshes. A run whose depth gives none has its other numbers all the same; empty: made.
std::string why_no_mesh(
    const RunSpec& spec, const Scene& scene, Method& method, const TsdfOptions& options
) {
  if (!has_tsdf_volume()) return "no Open3D";
  try {
    mesh_stage(spec, scene, method, options);
    return {};
  } catch (const Error& error) {
    if (error.code() == ExitCode::kEnvironment) throw;  // nothing that another run would lack
    log::warn(fmt::format("{}: no mesh: {}", spec.folder.string(), error.what()));
    return fmt::format("no mesh: {}", error.what());
  }
}

// Runs the plan cell by cell, with one scene in memory at a time.
class Runner {
 public:
  explicit Runner(const RunnerOptions& options)
      : options_(options), records_file_(options.out / "records.jsonl") {}

  RunSummary run() {
    const auto plan = make_plan(options_.profile, options_.filter, options_.assignments);
    records_ = read_records(records_file_);
    for (std::size_t i = 0; i < plan.size(); ++i) try {
        throw_if_interrupted();
        log::info(fmt::format("[{}/{}] {}", i + 1, plan.size(), plan[i].cell.text()));
        run_one(plan[i]);
      } catch (const Interrupted&) {
        summary_.interrupted = true;
        break;
      }
    return summary_;
  }

 private:
  void run_one(const PlanCell& cell) {
    if (is_done(cell, scene_hash(cell.source))) return reuse();
    if (!load_scene_of(cell)) return;
    if (!cell.source.made() && is_done(cell, loaded_.scene.spec_hash)) return reuse();
    finish(run_cell(cell, options_, loaded_));
  }

  bool is_done(const PlanCell& cell, const std::string& dataset_hash) const {
    return !options_.force && !dataset_hash.empty() &&
           state_of(cell, records_, dataset_hash) == CellState::kDone;
  }

  void reuse() {
    log::info("  finished earlier, reused (--force runs it again)");
    ++summary_.reused;
  }

  // False: the scene cannot be had, and the cell has failed for it.
  bool load_scene_of(const PlanCell& cell) {
    if (loaded_name_ == cell.cell.scene) return true;
    try {
      loaded_ = options_.load(cell.source);
      GLINT_CHECK(
          !loaded_.scene.test.empty() && !loaded_.scene.train.empty(),
          kBadReference,
          "{}: {} training and {} test views; both are needed",
          loaded_.folder.string(),
          loaded_.scene.train.size(),
          loaded_.scene.test.size()
      );
      loaded_name_ = cell.cell.scene;
      return true;
    } catch (const std::exception& error) {
      Record record = record_of(cell, options_);
      record.failure = failure_of(error, "dataset", {});
      finish(record);
      return false;
    }
  }

  void finish(const Record& record) {
    append_record(records_file_, record);
    if (record.ok()) {
      ++summary_.ran;
      return;
    }
    ++summary_.failed;
    log::warn(fmt::format(
        "{} failed in {}: {}", record.cell.text(), record.failure->stage, record.failure->message
    ));
  }

  const RunnerOptions& options_;
  fs::path records_file_;
  std::vector<Record> records_;
  LoadedScene loaded_;
  std::string loaded_name_;
  RunSummary summary_;
};

}  // namespace

RunSummary run_profile(const RunnerOptions& options) { return Runner(options).run(); }

RunScores render_and_score(
    const RunSpec& spec, const Scene& scene, Method& method, const Profile& profile
) {
  RunScores scores;
  scores.not_measured = missing_metrics();
  render_stage(spec, scene, method);
  std::map<std::string, double> costs{
      {"fps", measure_fps(method, scene, {profile.timing_frames, profile.timing_warmup})},
      {"num-surfels", static_cast<double>(method.num_surfels())}};
  if (const std::optional<TrainCost> cost = trained_cost(spec)) {
    costs["train-minutes"] = cost->seconds / 60;
    costs["peak-memory"] = cost->peak_memory_mb;
  }
  if (const std::string why = why_no_mesh(spec, scene, method, profile.tsdf_options());
      !why.empty())
    for (const Metric& metric : mesh_metric_list()) scores.not_measured[metric.id] = why;
  scores.means = eval_stage(spec, scene, costs, profile.mesh_protocol());
  scores.not_applicable = not_applicable(scores.means, scores.not_measured);
  return scores;
}

std::string failure_kind(const std::exception& error, const std::string& stage) {
  if (dynamic_cast<const std::bad_alloc*>(&error)) return "out-of-memory";
  const auto* ours = dynamic_cast<const Error*>(&error);
  if (!ours) return "unknown";
  switch (ours->code()) {
    case ExitCode::kBadPrediction:
      return stage == "train" ? "not-finite" : "bad-input";
    case ExitCode::kBadReference:
      return "bad-input";
    case ExitCode::kUsage:
      return "usage";
    case ExitCode::kEnvironment:
      return "environment";
    default:
      return "unknown";
  }
}

}  // namespace glint
