// SPDX-License-Identifier: MIT
#include <algorithm>

#include "glint/core/machine.h"
#include "glint/train/trainer.h"
#include "reports/bench/stages.h"
#include "reports/records/earlier_run.h"
#include "reports/records/stage_files.h"

namespace glint {

namespace {

constexpr int kLogLines = 400;   // at most, of a run
constexpr int kCheckpoints = 5;  // of a run, each over the last

TrainOptions train_options(const RunSpec& spec) {
  TrainOptions options;
  options.run = spec.options;
  options.folder = spec.folder;
  options.log_interval = std::max(1, spec.options.iterations / kLogLines);
  options.save_interval = std::max(1, spec.options.iterations / kCheckpoints);
  options.title = fmt::format("{} {}", spec.scene, spec.method);
  return options;
}

}  // namespace

std::unique_ptr<Method> train_stage(const RunSpec& spec, const Scene& scene) {
  auto method = create_method(spec.method, spec.config);
  EarlierRun earlier(spec.folder);
  write_run_spec(spec, method->config());
  reset_peak_memory();
  const TrainReport report = train(*method, scene, train_options(spec));
  const double peak_memory = peak_memory_mb();
  const auto files =
      save_in_place(spec.folder, [&](const fs::path& folder) { method->save(folder.string()); });
  write_trained(spec, {report.seconds, peak_memory, method->warnings(), method->notes()});
  write_stage(spec.folder, Stage::kTrain, spec.train_document, files);
  earlier.drop();
  return method;
}

}  // namespace glint
