// SPDX-License-Identifier: MIT
#include "glint/train/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>

#include "glint/core/device.h"
#include "glint/core/device_lost.h"
#include "glint/core/interrupt.h"
#include "glint/core/machine.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/core/rng.h"
#include "glint/render/void_steps.h"
#include "glint/train/checkpoint.h"
#include "glint/train/test_psnr.h"

namespace glint {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Json log_line(const StepStats& stats, const TrainingProgress& done) {
  Json line = {
      {"iteration", stats.iteration},
      {"loss", stats.loss},
      {"psnr", stats.psnr},
      {"num_surfels", stats.num_surfels},
      {"seconds", done.seconds},
      {"saving_seconds", done.saving_seconds},
      {"void_steps", done.void_steps.count}};
  for (const auto& [name, value] : stats.terms) line["terms"][name] = value;
  for (const auto& [name, size] : stats.sets) line["sets"][name] = size;
  return line;
}

// On a GPU the host looks at losses this often; in between it waits for nothing.
constexpr int kToldInterval = 20;

template <class F>
void for_each_image(const View& view, F&& f) {
  f(view.rgb);
  if (!view.counted.empty()) f(view.counted);
  view.priors.for_each([&](const MapRow&, const Image& map) { f(map); });
  view.truth.for_each([&](const MapRow&, const Image& map) { f(map); });
}

// Images of views come to the device when a step first needs them. They stay there if all of them
// fill at most half of it; else each step's leave, and come again.
class ImagesOnDevice {
 public:
  explicit ImagesOnDevice(const Scene& scene) : views_(scene.train) {
    std::size_t bytes = 0;
    for (const View& view : views_)
      for_each_image(view, [&](const Image& image) {
        bytes += image.num_pixels() * static_cast<std::size_t>(image.channels()) * sizeof(float);
      });
    stay_ = !on_gpu() || bytes <= device_room() / 2;
  }
  void end_step() const {
    if (stay_) return;
    for (const View& view : views_)
      for_each_image(view, [](const Image& image) { image.array().leave_device(); });
  }

 private:
  const std::vector<View>& views_;
  bool stay_;
};

// Lines of the log from this iteration on will be written again.
void cut_log(const fs::path& file, int iteration) {
  if (!is_there(file)) return;
  std::istringstream log(read_file(file));
  std::string kept;
  for (std::string line; std::getline(log, line);) {
    if (number_or(parse_json(line), "iteration", iteration) < iteration) kept += line + "\n";
  }
  write_file(file, kept);
}

class Training {
 public:
  Training(Method& method, const Scene& scene, const TrainOptions& options)
      : method_(method),
        scene_(scene),
        options_(options),
        checkpoint_(options.folder / kCheckpointFile),
        log_(options.folder / "log.jsonl"),
        on_disk_(!options.folder.empty()),
        test_psnr_(scene, options.test_psnr_every) {}

  TrainReport run() {
    begin();
    Progress progress(options_.title, static_cast<std::size_t>(options_.run.iterations));
    progress.advance(static_cast<std::size_t>(done_.iterations));
    const ImagesOnDevice images(scene_);
    for (int i = done_.iterations; i < options_.run.iterations; ++i) {
      if (is_interrupted()) stop();
      take_step(i, images);
      progress.advance(1, progress_text());
    }
    method_.check_finite();
    if (on_disk_) write_progress();
    return report();
  }

 private:
  // What is left of the run when it fails.
  std::string where() const {
    if (!on_disk_) return "nothing was to be kept";
    if (!is_taken(checkpoint_)) return "before the first checkpoint";
    return "the last checkpoint is " + checkpoint_.string();
  }
  template <class F>
  auto on_device(int iteration, F&& work) {
    try {
      return work();
    } catch (const DeviceLost& lost) {
      throw DeviceLost(
          fmt::format("training stopped at iteration {}, {}: {}", iteration, where(), lost.what())
      );
    }
  }

  void begin() {
    method_.initialize(scene_, options_.run);
    for (const std::string& warning : method_.warnings()) log::warn(warning);
    if (on_disk_ && is_checkpoint_of(checkpoint_, options_.identity)) resume();
    first_ = done_.iterations;
    take_void_steps();  // of a training that failed in this process
    last_checkpoint_ = Clock::now();
  }

  void resume() {
    try {
      read_checkpoint(checkpoint_, method_, done_);
      events_ = Json::parse(done_.events, nullptr, false);
      if (!events_.is_array()) events_ = Json::array();
      log::info(fmt::format("{}: goes on at iteration {}", options_.title, done_.iterations));
    } catch (const Error& error) {
      log::warn(fmt::format("{}; starting anew", error.what()));
      done_ = {};
      method_.initialize(scene_, options_.run);
    }
    cut_log(log_, done_.iterations);
  }

  // Of these the host looks at what a step computed.
  bool is_logged(int i) const {
    return (i + 1) % options_.log_interval == 0 || i + 1 == options_.run.iterations || is_tested(i);
  }
  bool is_tested(int i) const { return on_disk_ && test_psnr_.is_due(i, options_.run.iterations); }
  bool is_told(int i) const { return !on_gpu() || is_logged(i) || i % kToldInterval == 0; }

  void take_step(int i, const ImagesOnDevice& images) {
    const auto start = Clock::now();
    const StepStats stats = on_device(i, [&] {
      const SilentStep silent(!is_told(i));
      StepStats result = method_.step(i);
      end_silent_step(i);
      images.end_step();
      return result;
    });
    done_.seconds += seconds_since(start);
    done_.iterations = i + 1;
    for (const std::string& event : stats.events) note(i, event);
    if (is_told(i)) take_note(stats);
    if (options_.after_step) call_after_step(stats);
    if (is_told(i) && on_disk_ && checkpoint_is_due()) save();
  }

  void take_note(const StepStats& stats) {
    check(stats);
    last_ = stats;
    count_void_steps();
    if (on_disk_ && is_logged(stats.iteration)) append_log(stats);
  }
  void call_after_step(const StepStats& stats) {
    try {
      options_.after_step(method_, stats);
    } catch (...) {
      save_if_resumable();
      throw;
    }
  }

  void count_void_steps() {
    const VoidSteps found = take_void_steps();
    if (found.count == 0) return;
    done_.void_steps.count += found.count;
    done_.void_steps.last = found.last;
    note(
        found.last,
        fmt::format("{} steps were left out: no room for their pairs or hits yet", found.count)
    );
  }
  void note(int iteration, const std::string& event) {
    events_.push_back({{"iteration", iteration}, {"text", event}});
  }
  void append_log(const StepStats& stats) {
    Json line = log_line(stats, done_);
    if (!events_.empty()) line["events"] = std::exchange(events_, Json::array());
    if (is_tested(stats.iteration))
      line["test_psnr"] = on_device(stats.iteration, [&] { return test_psnr_.measure(method_); });
    append_line(log_, line.dump());
  }
  std::string progress_text() const {
    return fmt::format(
        "loss {:.4f}  psnr {:.2f}  {} surfels", last_.loss, last_.psnr, last_.num_surfels
    );
  }

  // No more than a fiftieth of the time goes into checkpoints.
  bool checkpoint_is_due() const {
    if (!resumable_) return false;
    if (options_.checkpoint_seconds == 0) return true;
    return seconds_since(last_checkpoint_) >=
           std::max(options_.checkpoint_seconds, 50 * last_saving_seconds_);
  }
  // The last good one stays where there is no room for a new one.
  void save() {
    const auto start = Clock::now();
    method_.check_finite();
    note_memory();
    count_void_steps();
    done_.events = events_.dump();
    on_device(done_.iterations, [&] {
      try {
        resumable_ = write_checkpoint(checkpoint_, options_.identity, method_, done_);
        if (resumable_) write_progress();
      } catch (const DeviceLost&) {
        throw;
      } catch (const Error& error) {
        log::warn(fmt::format("no checkpoint: {}", error.what()));
      }
    });
    last_saving_seconds_ = seconds_since(start);
    done_.saving_seconds += last_saving_seconds_;
    last_checkpoint_ = Clock::now();
  }
  void write_progress() const {
    const Json progress = {
        {"iterations", done_.iterations},
        {"of", options_.run.iterations},
        {"seconds", done_.seconds},
        {"ended", done_.iterations >= options_.run.iterations}};
    write_file(options_.folder / kProgressFile, progress.dump() + "\n");
  }
  [[noreturn]] void stop() {
    save_if_resumable();
    throw Interrupted();
  }
  void save_if_resumable() {
    const bool anything = done_.iterations > first_;
    if (on_disk_ && resumable_ && anything) save();
  }

  void check(const StepStats& stats) const {
    if (std::isfinite(stats.loss)) return;
    const std::string stopped =
        fmt::format("training stopped at iteration {}, {}", stats.iteration, where());
    try {
      method_.check_finite();
    } catch (const Error& culprit) {
      throw Error(ExitCode::kBadPrediction, fmt::format("{}: {}", stopped, culprit.what()));
    }
    for (const auto& [name, value] : stats.terms)
      GLINT_CHECK(
          std::isfinite(value), kBadPrediction, "{}: loss term {} is {}", stopped, name, value
      );
    throw Error(ExitCode::kBadPrediction, fmt::format("{}: the loss is {}", stopped, stats.loss));
  }
  void note_memory() {
    done_.peak_memory_mb = std::max(done_.peak_memory_mb, peak_memory_mb());
    done_.device_memory_mb = std::max(done_.device_memory_mb, device_peak_mb());
  }
  TrainReport report() {
    note_memory();
    TrainReport report;
    report.iterations = done_.iterations;
    report.seconds = done_.seconds;
    report.saving_seconds = done_.saving_seconds;
    report.peak_memory_mb = done_.peak_memory_mb;
    report.device_memory_mb = done_.device_memory_mb;
    report.num_surfels = method_.num_surfels();
    report.void_steps = done_.void_steps;
    report.last = last_;
    return report;
  }

  Method& method_;
  const Scene& scene_;
  const TrainOptions& options_;
  fs::path checkpoint_, log_;
  bool on_disk_, resumable_ = true;
  TestPsnr test_psnr_;
  TrainingProgress done_;
  int first_ = 0;                // iteration of this process
  StepStats last_;               // that the host was told
  Json events_ = Json::array();  // since the last line of the log
  Clock::time_point last_checkpoint_;
  double last_saving_seconds_ = 0;
};

}  // namespace

int scaled_step(int published, int iterations, int at_least, int of) {
  const double scaled = static_cast<double>(published) * iterations / of;
  const double most = std::numeric_limits<int>::max() / 2;  // sums of two fit
  return std::max(at_least, static_cast<int>(std::lround(std::min(scaled, most))));
}

ViewSampler::ViewSampler(std::size_t num_views, std::uint64_t seed)
    : num_views_(num_views), seed_(seed) {}

void ViewSampler::check_views() const {
  for (const std::size_t view : remaining_)
    GLINT_CHECK(view < num_views_, kBadReference, "view {} of {}", view, num_views_);
}

std::size_t ViewSampler::next() {
  if (remaining_.empty()) {
    remaining_.resize(num_views_);
    std::iota(remaining_.begin(), remaining_.end(), std::size_t{0});
    Rng rng(seed_, hash_name("views") + epoch_++);
    for (std::size_t i = num_views_; i > 1; --i)
      std::swap(remaining_[i - 1], remaining_[rng.below(static_cast<std::uint32_t>(i))]);
  }
  const std::size_t view = remaining_.back();
  remaining_.pop_back();
  return view;
}

TrainReport train(Method& method, const Scene& scene, const TrainOptions& options) {
  GLINT_CHECK(!scene.train.empty(), kBadReference, "{}: no training views", scene.name);
  return Training(method, scene, options).run();
}

}  // namespace glint
