// SPDX-License-Identifier: MIT
#include <algorithm>

#include "glint/core/machine.h"
#include "glint/train/checkpoint.h"
#include "glint/train/trainer.h"
#include "reports/bench/run_stage.h"
#include "reports/bench/stages.h"

namespace glint {

namespace {

constexpr int kLogLines = 400;  // at most, of a run

TrainOptions train_options(const RunSpec& spec) {
  TrainOptions options;
  options.run = spec.options;
  options.folder = spec.folder;
  options.log_interval = std::max(1, spec.options.iterations / kLogLines);
  options.checkpoint_seconds = spec.checkpoint_seconds;
  options.identity = stage_key(spec.train_document);
  options.title = fmt::format("{} {}", spec.scene, spec.method);
  return options;
}

}  // namespace

std::unique_ptr<Method> train_stage(const RunSpec& spec, const Scene& scene) {
  const fs::path checkpoint = spec.folder / kCheckpointFile;
  if (spec.anew || !is_checkpoint_of(checkpoint, stage_key(spec.train_document)))
    clear_run_folder(spec.folder);
  auto method = create_method(spec.method, spec.config);
  write_run_spec(spec, method->config());
  reset_peak_memory();
  const TrainReport report = train(*method, scene, train_options(spec));
  method->save(spec.folder.string());
  write_trained(spec, {report.seconds, report.peak_memory_mb, method->warnings(), method->notes()});
  end_stage(spec.folder, Stage::kTrain, spec.train_document);
  fs::remove(checkpoint);
  return method;
}

}  // namespace glint
