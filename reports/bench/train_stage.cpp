// SPDX-License-Identifier: MIT
#include <algorithm>

#include "glint/core/interrupt.h"
#include "glint/core/machine.h"
#include "glint/train/trainer.h"
#include "reports/bench/run_stage.h"
#include "reports/bench/stages.h"

namespace glint {

namespace {

constexpr int kLogLines = 400;   // at most, of a run
constexpr int kCheckpoints = 5;  // of a run, each over the last

// The method, but Ctrl-C stops it before its next step.
class InterruptibleMethod final : public Method {
 public:
  explicit InterruptibleMethod(Method& method) : method_(method) {}
  StepStats step(int iteration) override {
    throw_if_interrupted();
    return method_.step(iteration);
  }
  void initialize(const Scene& scene, const RunOptions& options) override {
    method_.initialize(scene, options);
  }
  RenderOutput render(const Camera& camera) const override { return method_.render(camera); }
  void draw(const Camera& camera) const override { method_.draw(camera); }
  void save(const std::string& folder) const override { method_.save(folder); }
  void load(const std::string& folder) override { method_.load(folder); }
  Json config() const override { return method_.config(); }
  void check_finite() const override { method_.check_finite(); }
  std::size_t num_surfels() const override { return method_.num_surfels(); }
  std::vector<std::string> warnings() const override { return method_.warnings(); }

 private:
  Method& method_;
};

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
  clear_run_folder(spec.folder);
  auto method = create_method(spec.method, spec.config);
  write_run_spec(spec, method->config());
  reset_peak_memory();
  InterruptibleMethod interruptible(*method);
  const TrainReport report = train(interruptible, scene, train_options(spec));
  const double peak_memory = peak_memory_mb();
  method->save(spec.folder.string());
  write_trained(spec, {report.seconds, peak_memory, method->warnings()});
  end_stage(spec.folder, Stage::kTrain, spec.train_document);
  return method;
}

}  // namespace glint
