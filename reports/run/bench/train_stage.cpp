// SPDX-License-Identifier: MIT
#include <algorithm>

#include "glint/core/device.h"
#include "glint/core/machine.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/train/checkpoint.h"
#include "glint/train/trainer.h"
#include "reports/run/bench/stages.h"
#include "reports/run/records/earlier_run.h"
#include "reports/run/records/stage_files.h"

namespace glint {

namespace {

constexpr int kLogLines = 400;  // at most, of a run

TrainOptions train_options(const RunSpec& spec) {
  TrainOptions options;
  options.run = spec.options;
  options.folder = spec.folder;
  options.log_interval = std::max(1, spec.options.iterations / kLogLines);
  options.test_psnr_every = spec.test_psnr_every;
  options.checkpoint_seconds = spec.checkpoint_seconds;
  options.identity = stage_key(spec.train_document);
  options.title = fmt::format("{} {}", spec.scene, spec.method);
  return options;
}

}  // namespace

std::unique_ptr<Method> train_stage(
    const RunSpec& spec, const Scene& scene, const AfterStep& after_step
) {
  const fs::path checkpoint = spec.folder / kCheckpointFile;
  const bool goes_on = !spec.anew && is_checkpoint_of(checkpoint, stage_key(spec.train_document));
  if (!goes_on && !spec.anew && is_there(checkpoint))
    log::warn(checkpoint.string() + ": damaged, or of other settings, data or code; starting anew");
  auto method = create_method(spec.method, spec.config);
  EarlierRun earlier(spec.folder, goes_on);
  write_run_spec(spec, method->config());
  reset_peak_memory();
  reset_device_peak();
  TrainOptions options = train_options(spec);
  options.after_step = after_step;
  const TrainReport report = train(*method, scene, options);
  auto files =
      save_in_place(spec.folder, [&](const fs::path& folder) { method->save(folder.string()); });
  write_trained(
      spec,
      {report.seconds,
       report.peak_memory_mb,
       report.device_memory_mb,
       method->warnings(),
       method->notes(),
       scene.data_notes,
       {{"count", report.void_steps.count}, {"last", report.void_steps.last}}}
  );
  files.emplace_back("env.json");
  write_stage(spec.folder, Stage::kTrain, spec.train_document, files);
  fs::remove(checkpoint);
  earlier.drop();
  return method;
}

}  // namespace glint
